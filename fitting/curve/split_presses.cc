#include "fitting/curve/split_presses.h"

#include <algorithm>

namespace palpate {
namespace {

constexpr double kPositionNoise = 2e-3;  // [-] of the travel: a stage's position noise

double sign_of_compression(const std::vector<double>& x) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  return x.front() - *low > *high - x.front() ? -1.0 : 1.0;
}

// First samples of all presses but the first.
std::vector<std::size_t> later_begins(const std::vector<double>& x) {
  const double sign = sign_of_compression(x);
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  const double travel = *most - *least, turn = kPressShareMin * travel;
  std::vector<std::size_t> begins;
  bool pressed = false, releasing = false;
  double high = sign * x.front(), low = high;
  std::size_t lowest = 0;  // where the tool came to rest, if it did
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double at = sign * x[i];
    if (!releasing) {
      high = std::max(high, at);
      pressed = pressed || at > low + turn;
      low = std::min(low, at);
    }
    if (!releasing && at < high - turn) {
      releasing = true;
      low = at;
      lowest = i;
    } else if (releasing) {
      lowest = at < low - kPositionNoise * travel ? i : lowest;
      low = std::min(low, at);
      if (at > low + turn) {
        if (pressed) {
          begins.push_back(lowest);
        }
        releasing = false;
        pressed = true;
        high = at;
      }
    }
  }
  return begins;
}

Measurement piece(const Measurement& m, std::size_t begin, std::size_t end) {
  const auto cut = [&](const std::vector<double>& values) {
    return values.size() == m.depth_m.size()
               ? std::vector<double>(
                     values.begin() + static_cast<std::ptrdiff_t>(begin),
                     values.begin() + static_cast<std::ptrdiff_t>(end))
               : std::vector<double>();
  };
  Measurement part{cut(m.depth_m), cut(m.force_n)};
  part.time_s = cut(m.time_s);
  part.depth_errors_m = cut(m.depth_errors_m);
  part.force_errors_n = cut(m.force_errors_n);
  return part;
}

}  // namespace

std::vector<Measurement> split_presses(const Measurement& measurement) {
  if (measurement.depth_m.empty() ||
      measurement.depth_m.size() != measurement.force_n.size()) {
    return {measurement};
  }
  std::vector<std::size_t> end = later_begins(measurement.depth_m);
  if (end.empty()) {
    return {measurement};
  }
  end.push_back(measurement.depth_m.size());
  std::vector<Measurement> presses;
  std::size_t begin = 0;
  for (const std::size_t until : end) {
    presses.push_back(piece(measurement, begin, until));
    begin = until;
  }
  return presses;
}

}  // namespace palpate
