#include "runtime/served/served_report.h"

#include <numeric>

#include <fmt/format.h>

namespace palpate {

std::string quality_csv(const ServedReport& report) {
  std::string text = "second,none,estimated,preliminary,final\n";
  for (std::size_t i = 0; i < report.by_second.size(); ++i) {
    const QualityTicks& at = report.by_second[i];
    const auto all =
        static_cast<double>(std::accumulate(at.begin(), at.end(), std::int64_t{0}));
    if (all == 0.0) {
      continue;
    }
    text += fmt::format("{}", i);
    for (const std::int64_t ticks : at) {
      text += fmt::format(",{:.4f}", static_cast<double>(ticks) / all);
    }
    text += "\n";
  }
  return text;
}

}  // namespace palpate
