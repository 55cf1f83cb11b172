#include "fitting/curve/sample_clock.h"

namespace palpate {

std::vector<double> sample_clock(const std::vector<double>& time_s, std::size_t n) {
  const bool timed = !time_s.empty() && time_s.back() > time_s.front();
  std::vector<double> clock(n);
  for (std::size_t i = 0; i < n; ++i) {
    clock[i] = timed ? (time_s[i] - time_s.front()) / (time_s.back() - time_s.front())
                     : static_cast<double>(i) / static_cast<double>(n - 1);
  }
  return clock;
}

}  // namespace palpate
