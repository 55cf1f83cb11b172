// How the contact under a tool bears, at every node and at four depths. The tables say
// where the pressure acts, and how stiff the contact is sideways while it sticks.
//
// Depths are shares of the curve's last one (kContactDepthShares). Directions are those
// of the node's frame: x and y of tangent_frame(normal). A symmetric 2 x 2 tensor is
// kept as xx, xy, yy.
//
// Pressure. The model is an ellipse with semi-axes a and b, about a centre c,
//
//   p = p_0 (1 - rho^2)^m,   p_0 = (m + 1) N / (pi a b),   a^2 = 2 (m + 2) M_aa.
//
// N is the force along the normal, M the second moments of the pressure about c, over
// N. The exponent m follows from the fourth moment,
// <rho^4> / <rho^2>^2 = 2 (m + 2) / (m + 3). Hertz has m = 1/2, a rigid punch -1/2.
//
// Lateral stiffness. The tangent plane's displacement t of a contact that sticks is
// answered by the force -K t,
//
//   K(d) = S(d) N / d,   d the normal depth past the touch.
//
// A ball on a half-space has S = 3 (1 - nu) / (2 - nu) times the identity, at every
// depth. (Mindlin 1949, Compliance of elastic bodies in contact: K = 8 a G / (2 - nu).)
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Core>

#include "formats/response/contact_depths.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// [-] Largest mean eigenvalue of S that a file may hold.
inline constexpr double kLateralMost = 100.0;
/// [-] Exponents m of pressures.
inline constexpr double kPressureExponentLeast = -0.9;
inline constexpr double kPressureExponentMost = 20.0;

/// Rows of the nodes. A node without a response, or whose contact is not known, has 0.
/// Parts that nobody computed have no rows.
struct ContactTable {
  RowsOf<float> centre_m = {};        ///< (n x 2 D) [m] c, off the node's line
  RowsOf<float> moment_m2 = {};       ///< (n x 3 D) [m^2] M, positive definite
  RowsOf<float> exponent = {};        ///< (n x D) [-] m
  RowsOf<float> pressure_error = {};  ///< (n x 1) [-] of the radius, from d/4 on
  RowsOf<float> lateral = {};         ///< (n x 3 D) [-] S, positive definite
  RowsOf<float> lateral_error = {};   ///< (n x 1) [-] stated error of K, any direction

  [[nodiscard]] bool has_pressure() const noexcept { return moment_m2.rows() > 0; }
  [[nodiscard]] bool has_lateral() const noexcept { return lateral.rows() > 0; }
  [[nodiscard]] bool empty() const noexcept {
    return !has_pressure() && !has_lateral();
  }
};

/// Calls take(name, units, columns, rows) for each dataset, in the digest's order.
/// @param name of the dataset within a tool's group.
template <typename Table, typename Take>
void for_each_contact_dataset(Table& table, const Take& take) {
  constexpr auto kD = static_cast<Eigen::Index>(kContactDepths);
  take("/pressure/centre_m", "m", 2 * kD, table.centre_m);
  take("/pressure/moment_m2", "m2", 3 * kD, table.moment_m2);
  take("/pressure/exponent", "1", kD, table.exponent);
  take("/pressure/error_relative", "1", Eigen::Index{1}, table.pressure_error);
  take("/lateral/stiffness", "1", 3 * kD, table.lateral);
  take("/lateral/error_relative", "1", Eigen::Index{1}, table.lateral_error);
}

/// Stacks tables of one node each, or of none: then the node's row is 0.
[[nodiscard]] ContactTable stacked(std::span<const ContactTable* const> row);

/// The rows of some nodes, in their order. @param nodes rows of the whole.
[[nodiscard]] ContactTable rows_of(const ContactTable& table,
                                   std::span<const std::int32_t> nodes);

/// What breaks the rules of a row: a sentence's end, or empty.
[[nodiscard]] std::string broken_contact_row(const ContactTable& table,
                                             Eigen::Index row);

/// The pressure under a tool at a place and depth.
struct ContactPressure {
  double normal_n = 0.0;                                ///< [N] N
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();   ///< [m]
  Eigen::Matrix2d moment_m2 = Eigen::Matrix2d::Zero();  ///< [m^2]
  double exponent = 0.5;                                ///< [-]

  /// [m] of a disc with the ellipse's area, sqrt(a b).
  [[nodiscard]] double radius_m() const;
  /// [Pa] p_0: the largest where the exponent is not negative, else that of the middle.
  [[nodiscard]] double middle_pa() const;
};

/// Of a node at a depth. Between the stored depths the numbers are linear in the depth;
/// below the first the moments fall with it.
/// @param share [-] [0, 1] of the curve's last depth; more counts as 1.
/// @param normal_n [N] there.
[[nodiscard]] ContactPressure pressure_at(const ContactTable& table, Eigen::Index row,
                                          double share, double normal_n);

/// S of a node at a depth; constant below the first stored depth. As above.
[[nodiscard]] Eigen::Matrix2d lateral_at(const ContactTable& table, Eigen::Index row,
                                         double share);

/// [-] Largest difference of two tables at the stored depths, over the first's: of the
/// pressure's radius, and of S by its Frobenius norm. 1: one of them lacks a part or a
/// row.
[[nodiscard]] double relative_difference(const ContactTable& a, const ContactTable& b);

/// One line for people, or empty.
[[nodiscard]] std::string describe(const ContactTable& table);

}  // namespace palpate
