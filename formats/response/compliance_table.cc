#include "formats/response/compliance_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/reproducible.h"

namespace palpate {

std::span<const float> compliance_row(const ComplianceTable& table, std::int64_t node) {
  return {table.value.row(node).data(), table.knots()};
}

std::vector<double> log_spaced(double first_m, double last_m, std::size_t count) {
  std::vector<double> distance_m(count);
  const double log_ratio = reproducible::log(last_m / first_m);
  for (std::size_t k = 0; k < count; ++k) {
    distance_m[k] = first_m * reproducible::exp(log_ratio * static_cast<double>(k) /
                                                static_cast<double>(count - 1));
  }
  return distance_m;
}

ComplianceKnots knots_of(const ComplianceTable& table) {
  const double first_m = table.distance_m.front();
  return {first_m,
          reproducible::log(table.distance_m.back() / first_m) /
              static_cast<double>(table.knots() - 1),
          table.knots()};
}

namespace {

bool same_modes(const ComplianceTable& a, const ComplianceTable& b) {
  return a.modes() == b.modes() && a.mode == b.mode && a.added_modes == b.added_modes;
}

}  // namespace

double relative_difference(const ComplianceTable& a, const ComplianceTable& b) {
  if (a.empty() && b.empty()) {
    return 0.0;
  }
  if (a.empty() || b.empty() || a.value.rows() != b.value.rows() || !same_modes(a, b)) {
    return 1.0;
  }
  const ComplianceKnots knots = knots_of(b);
  double largest = 0.0;
  double off = 0.0;
  for (std::size_t k = 0; k < a.knots(); ++k) {
    const double r = a.distance_m[k];
    // At a common distance there is nothing to interpolate, nor to round.
    const bool common = k < b.knots() && b.distance_m[k] == r;
    const ComplianceWeights weights = compliance_weights(knots, r);
    for (Eigen::Index i = 0; i < a.value.rows(); ++i) {
      const auto v = static_cast<double>(a.value(i, static_cast<Eigen::Index>(k)));
      const double other =
          common ? static_cast<double>(b.value(i, static_cast<Eigen::Index>(k)))
                 : r * weights.of(compliance_row(b, i)).compliance_m_per_n;
      largest = std::max(largest, std::abs(v));
      off = std::max(off, std::abs(other - v));
    }
  }
  return off == 0.0 ? 0.0 : off / largest;
}

std::string describe(const ComplianceTable& table) {
  std::string text = fmt::format("{} distances from {:.3g} to {:.3g} mm, {} modes; ",
                                 table.knots(), 1e3 * table.distance_m.front(),
                                 1e3 * table.distance_m.back(), table.modes());
  text += table.error_relative > 0.0
              ? fmt::format(
                    "forces of several contacts within {:.2g} % of the largest of "
                    "their set, at 95 % of sets",
                    100.0 * table.error_relative)
              : "error not known";
  return text + (table.convex ? "; one equilibrium"
                              : "; several equilibria in places, or not checked");
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

ComplianceModes contact_modes(const ComplianceTable& table,
                              std::span<const std::int32_t> nodes,
                              std::span<const double> weights) noexcept {
  ComplianceModes modes{};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t m = 0; m < table.modes(); ++m) {
      modes[m] += weights[i] * static_cast<double>(
                                   table.mode(nodes[i], static_cast<Eigen::Index>(m)));
    }
  }
  return modes;
}

double node_coupling_m_per_n(const ComplianceTable& table, const ComplianceKnots& knots,
                             std::int64_t one, std::int64_t other,
                             double distance_m) noexcept {
  const ComplianceWeights weights = compliance_weights(knots, distance_m);
  const double by_distance =
      weights.of(compliance_row(table, one)).compliance_m_per_n +
      weights.of(compliance_row(table, other)).compliance_m_per_n;
  return 0.5 * by_distance +
         coupling_by_modes(table.mode.row(one).data(), table.mode.row(other).data(),
                           table.modes(), static_cast<std::size_t>(table.added_modes));
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
