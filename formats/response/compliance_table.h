// How contacts of tools couple through a body: at every node, the compliance between it
// and places at a distance (compliance_row.h).
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "formats/response/compliance_row.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// Of one body, as a tool's table keeps it; without knots where contacts do not couple.
struct ComplianceTable {
  std::vector<double> distance_m = {};  ///< (K) [m] > 0, evenly spaced in ln; [4, 32]
  RowsOf<float> value = {};             ///< (n x K) [m^2/N] c(r) r; 0: it does not move
  RowsOf<float> mode = {};       ///< (n x M) [m^1/2 N^-1/2] M at most 16; or empty
  std::int64_t added_modes = 0;  ///< the first of M, [0, M]; the others subtract
  /// [-] 95 % of sets of contacts have every force within this share of the largest of
  /// the set. Measured at sets that were solved jointly; 0: not known.
  double error_relative = 0.0;
  /// Every set of contacts that was tried at the table's distances has one equilibrium.
  bool convex = false;

  [[nodiscard]] bool empty() const noexcept { return distance_m.empty(); }
  [[nodiscard]] std::size_t knots() const noexcept { return distance_m.size(); }
  [[nodiscard]] std::size_t modes() const noexcept {
    return static_cast<std::size_t>(mode.cols());
  }
};

/// K distances from first to last, evenly spaced in ln [m].
/// @param count [4, 32]
[[nodiscard]] std::vector<double> log_spaced(double first_m, double last_m,
                                             std::size_t count);

/// @param table with distances.
[[nodiscard]] ComplianceKnots knots_of(const ComplianceTable& table);

/// Largest difference of two tables at the first's distances, over the first's largest
/// number [-]. The result is 1 where one of the tables is empty or has other nodes or
/// modes.
[[nodiscard]] double relative_difference(const ComplianceTable& a,
                                         const ComplianceTable& b);

/// One line for people: over which distances contacts couple, and how well that is
/// known.
/// @param table with distances; rows are not read.
[[nodiscard]] std::string describe(const ComplianceTable& table);

/// Row of a node, (K).
[[nodiscard]] std::span<const float> compliance_row(const ComplianceTable& table,
                                                    std::int64_t node);

/// Row of a place on the surface; beyond its K numbers 0.
using ComplianceRow = std::array<double, kMostKnots>;

/// Of a place in a triangle: the nodes' rows, weighted.
/// @param nodes (3). @param weights (3) [-] area coordinates.
[[nodiscard]] ComplianceRow contact_compliance(
    const ComplianceTable& table, std::span<const std::int32_t> nodes,
    std::span<const double> weights) noexcept;

/// Modes of a place; beyond its M numbers 0.
using ComplianceModes = std::array<double, kMostModes>;

/// Of a place in a triangle, as contact_compliance().
[[nodiscard]] ComplianceModes contact_modes(const ComplianceTable& table,
                                            std::span<const std::int32_t> nodes,
                                            std::span<const double> weights) noexcept;

/// Of C of two contacts at places with these rows what depends on distance, and
/// dC/d(distance).
[[nodiscard]] ComplianceSample coupling(const ComplianceKnots& knots,
                                        const ComplianceRow& one,
                                        const ComplianceRow& other,
                                        double distance_m) noexcept;

/// C of contacts at two nodes [m/N].
[[nodiscard]] double node_coupling_m_per_n(const ComplianceTable& table,
                                           const ComplianceKnots& knots,
                                           std::int64_t one, std::int64_t other,
                                           double distance_m) noexcept;

}  // namespace palpate
