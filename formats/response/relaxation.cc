#include "formats/response/relaxation.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "formats/base/reproducible.h"

namespace palpate {
namespace {

std::string range_of(const std::vector<double>& values, double size = 1.0) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *low == *high ? fmt::format("{:.3g}", size * *low)
                       : fmt::format("{:.3g}..{:.3g}", size * *low, size * *high);
}

}  // namespace

double relaxed_share(const PronyTerms& terms, std::size_t row, double time_s) noexcept {
  return 1.0 + terms.g_1[row] * reproducible::expm1(-time_s / terms.tau_1_s[row]) +
         terms.g_2[row] * reproducible::expm1(-time_s / terms.tau_2_s[row]);
}

std::string describe(const ResponseRelaxation& relaxation) {
  const PronyTerms& terms = relaxation.terms;
  std::vector<double> left;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    left.push_back(relaxed_share(terms, i, relaxation.seconds));
  }
  return fmt::format(
      "held, {} % of the force stay after {:.3g} s: g {}, {}, tau {}, {} s; curves are "
      "of a press at {:.3g} mm/s; {} probes; {}",
      range_of(left, 100.0), relaxation.seconds, range_of(terms.g_1),
      range_of(terms.g_2), range_of(terms.tau_1_s), range_of(terms.tau_2_s),
      1e3 * relaxation.speed_m_per_s, relaxation.probes, relaxation.rule);
}

}  // namespace palpate
