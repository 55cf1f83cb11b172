#include "formats/response/compliance_table.h"

#include <cmath>

namespace palpate {

std::vector<double> log_spaced(double first_m, double last_m, std::size_t count) {
  std::vector<double> distance_m(count);
  const double log_ratio = std::log(last_m / first_m);
  for (std::size_t k = 0; k < count; ++k) {
    distance_m[k] = first_m * std::exp(log_ratio * static_cast<double>(k) /
                                       static_cast<double>(count - 1));
  }
  return distance_m;
}

ComplianceKnots knots_of(const ComplianceTable& table) {
  const double first_m = table.distance_m.front();
  return {first_m,
          std::log(table.distance_m.back() / first_m) /
              static_cast<double>(table.knots() - 1),
          table.knots()};
}

ComplianceRow contact_compliance(const ComplianceTable& table,
                                 std::span<const std::int32_t> nodes,
                                 std::span<const double> weights) noexcept {
  ComplianceRow row{};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t k = 0; k < table.knots(); ++k) {
      row[k] += weights[i] * static_cast<double>(
                                 table.value(nodes[i], static_cast<Eigen::Index>(k)));
    }
  }
  return row;
}

ComplianceSample coupling(const ComplianceKnots& knots, const ComplianceRow& one,
                          const ComplianceRow& other, double distance_m) noexcept {
  const ComplianceWeights weights = compliance_weights(knots, distance_m);
  const ComplianceSample a = weights.of(one);
  const ComplianceSample b = weights.of(other);
  return {0.5 * (a.compliance_m_per_n + b.compliance_m_per_n),
          0.5 * (a.slope_per_n + b.slope_per_n)};
}

}  // namespace palpate
