#include "fitting/curve/press_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fitting/curve/segments.h"

namespace palpate {
namespace {

constexpr std::size_t kRowsEnough = 800;     // more are averaged, ...
constexpr std::size_t kRampRowsEnough = 60;  // ... but not those of a fast ramp, ...
constexpr std::size_t kRampRowsMax = 1200;   // ... up to here for all ramps
constexpr std::size_t kGrowth = 8;  // a row is an eighth of its distance from a ramp

// Samples [begin, end) in which the tool stands, or moves, all the time.
struct Stretch {
  std::size_t begin = 0, end = 0;
  bool still = false, deep = false;
};

// The hold that is given, and what else stands in the displacement.
std::vector<Stretch> stretches_of(const PressAndHold& m) {
  // The given hold goes before what is found: a found stretch that overlaps it is cut
  // in two.
  std::vector<Stretch> still;
  for (const Segment& s : find_segments(m.displacement_m)) {
    if (s.kind == SegmentKind::kHold || s.kind == SegmentKind::kDwell) {
      const bool other = s.end <= m.hold_begin || s.begin >= m.hold_end;
      const bool deep = other && s.kind == SegmentKind::kHold;
      still.push_back({s.begin, std::min(s.end, m.hold_begin), true, deep});
      still.push_back({std::max(s.begin, m.hold_end), s.end, true, deep});
    }
  }
  still.push_back({m.hold_begin, m.hold_end, true, true});
  std::erase_if(still, [](const Stretch& s) {
    return s.begin >= s.end;
  });
  std::sort(still.begin(), still.end(), [](const Stretch& a, const Stretch& b) {
    return a.begin < b.begin;
  });
  // What lies between is in motion.
  std::vector<Stretch> all;
  std::size_t at = 0;
  for (const Stretch& s : still) {
    if (s.begin > at) {
      all.push_back({at, s.begin});
    }
    all.push_back(s);
    at = s.end;
  }
  if (at < m.time_s.size()) {
    all.push_back({at, m.time_s.size()});
  }
  return all;
}

// Samples [begin, end) of each row.
std::vector<Stretch> groups_of(const std::vector<Stretch>& stretches,
                               std::size_t samples) {
  const std::size_t most = (samples + kRowsEnough - 1) / kRowsEnough;
  const auto ramps = static_cast<std::size_t>(
      std::count_if(stretches.begin(), stretches.end(), [](const Stretch& s) {
        return !s.still;
      }));
  const std::size_t of_ramp =
      std::min(kRampRowsEnough, kRampRowsMax / std::max<std::size_t>(1, ramps));
  std::vector<Stretch> groups;
  for (const Stretch& s : stretches) {
    const std::size_t in_ramp =
        std::clamp<std::size_t>((s.end - s.begin) / of_ramp, 1, most);
    for (std::size_t at = s.begin; at < s.end;) {
      const std::size_t from_ramp = std::min(at - s.begin, s.end - at);
      const std::size_t size =
          s.still ? std::min(most, 1 + from_ramp / kGrowth) : in_ramp;
      const std::size_t end = std::min(at + size, s.end);
      groups.push_back({at, end, s.still, s.deep});
      at = end;
    }
  }
  return groups;
}

Eigen::VectorXd means_of(std::span<const double> values,
                         const std::vector<Stretch>& groups) {
  Eigen::VectorXd mean(std::ssize(groups));
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    const Stretch& group = groups[static_cast<std::size_t>(i)];
    const auto part = values.subspan(group.begin, group.end - group.begin);
    mean[i] = std::accumulate(part.begin(), part.end(), 0.0) /
              static_cast<double>(part.size());
  }
  return mean;
}

void scale(PressRows& rows) {
  rows.origin_m = rows.all.depth.minCoeff();
  rows.travel_m = rows.all.depth.maxCoeff() - rows.origin_m;
  rows.force_n = rows.all.force.cwiseAbs().maxCoeff();
  rows.all.depth = (rows.all.depth.array() - rows.origin_m) / rows.travel_m;
  rows.all.force /= rows.force_n;
}

}  // namespace

PressRows rows_of(const PressAndHold& m) {
  const std::size_t n = m.time_s.size();
  const std::vector<Stretch> stretches = stretches_of(m);
  const std::vector<Stretch> groups = groups_of(stretches, n);
  PressRows rows;
  rows.all = {means_of(m.time_s, groups), means_of(m.displacement_m, groups),
              means_of(m.force_n, groups), Eigen::VectorXd(std::ssize(groups))};
  scale(rows);
  for (Eigen::Index i = 0; i < rows.all.weight.size(); ++i) {
    const Stretch& g = groups[static_cast<std::size_t>(i)];
    // Root of the row's samples over the mean: squares of means then count as of
    // samples.
    rows.all.weight[i] =
        std::sqrt(static_cast<double>((g.end - g.begin) * groups.size()) /
                  static_cast<double>(n));
    rows.press += g.begin < m.hold_begin ? 1 : 0;
    rows.moving += g.begin < m.hold_begin && !g.still ? 1 : 0;
    rows.hold += g.begin < m.hold_end ? 1 : 0;
  }
  // Seconds of the press in motion: until the hold, less what stands.
  rows.moving_s = m.time_s[m.hold_begin] - m.time_s.front();
  for (const Stretch& s : stretches) {
    if (!s.still) {
      continue;
    }
    const double seconds = m.time_s[s.end - 1] - m.time_s[s.begin];
    rows.moving_s -= s.begin < m.hold_begin ? seconds : 0.0;
    if (s.deep) {
      const auto row = std::find_if(groups.begin(), groups.end(),
                                    [&](const Stretch& g) {
                                      return g.begin >= s.begin;
                                    }) -
                       groups.begin();
      rows.holds.push_back({row, rows.all.depth[row]});
      rows.hold_s = std::max(rows.hold_s, seconds);
    }
  }
  const double seconds = m.time_s.back() - m.time_s.front();
  rows.sample_s = seconds / static_cast<double>(n - 1);
  rows.interval_s = seconds / static_cast<double>(groups.size() - 1);
  return rows;
}

PressSamples first_rows(const PressSamples& all, Eigen::Index count) {
  return {all.time_s.head(count), all.depth.head(count), all.force.head(count),
          all.weight.head(count)};
}

}  // namespace palpate
