// Pressure by depth of an elastic foundation (Winkler bed). Under a ball of one radius
// the bed gives the forces of the stored press. Hydroelastic contact of simulators asks
// for such a law.
//
// A ball of radius R at penetration y meets the bed, at distance r from its axis, at
// the local depth y - r^2 / (2 R). Its normal force is F(y) = 2 pi R int_0^y p(s) ds.
// Hence p(y) = F'(y) / (2 pi R). A node with curve f and c = |n_out . u| has F(y) = c
// f(c y) and p(y) = c^2 f'(c y) / (2 pi R). (Johnson, Contact Mechanics, 4.3.) Hertz: p
// = E* sqrt(y / R) / pi with E* = E / (1 - nu^2).
//
// The law is exact for that radius alone, because points of a bed know no neighbours. A
// bed fitted at R gives F ~ R, Hertz's half space sqrt(R). At 2 R the bed is 41 % too
// stiff there, at R / 2 it is 29 % too soft.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "formats/response/response_table.h"

namespace palpate {

/// Depths are penetrations y along the outward normal past the first touch [m].
class PressureLaw {
 public:
  /// One node's part of a law.
  struct Part {
    CurveView curve;
    double weight = 1.0;   ///< [-] [0, 1]
    double lean = 1.0;     ///< [-] c
    double later_m = 0.0;  ///< [m] >= 0 by which it is touched later than the first
  };

  PressureLaw(double radius_m, std::vector<Part> parts);

  [[nodiscard]] double radius_m() const noexcept { return radius_m_; }

  /// The depth up to which all parts were computed [m]; beyond it pressure stays what
  /// it is where curves end.
  [[nodiscard]] double depth_max_m() const noexcept { return depth_max_m_; }

  /// p [Pa] at a depth; 0 for depths <= 0, NaN for NaN.
  [[nodiscard]] double pressure_pa(double depth_m) const noexcept;

  /// F [N] of a ball of another radius on the bed; of radius_m() the body's.
  [[nodiscard]] double force_n(double depth_m, double radius_m) const noexcept;

  /// int_0^y F of the law's own ball [J].
  [[nodiscard]] double energy_j(double depth_m) const noexcept;

  /// Where one of the cubics of a part begins or ends, up to depth_max_m(), from 0.
  [[nodiscard]] std::vector<double> knots_m() const;

 private:
  double radius_m_;
  double depth_max_m_;
  std::vector<Part> part_;
};

/// p = slope d, the law that simulators take by one number: Drake's hydroelastic
/// modulus over the thickness of the compliant layer, Newton's kh.
struct LinearPressure {
  double slope_pa_per_m = 0.0;        ///< [Pa/m] of least squares over depths
  double misfit_relative = 0.0;       ///< [-] rms of the difference over that of p
  double force_error_relative = 0.0;  ///< [-] of F at the largest depth, signed
};

/// Of depths in (0, depth_max_m]. @throws InputError for a depth that is not positive
/// and finite.
[[nodiscard]] LinearPressure linear_pressure(const PressureLaw& law,
                                             double depth_max_m);

/// @throws InputError unless the tool is a sphere: the law follows from its shape.
void check_gives_pressure(const ToolShape& tool);

/// Of one node. @param outward (3) [-] unit normal there. @throws InputError for
/// another tool than a sphere, and for a node that is none or has no response.
[[nodiscard]] PressureLaw pressure_law(const ResponseTable& table, std::int64_t node,
                                       const Eigen::Vector3d& outward);

/// Of a place in a triangle: the nodes' laws in these shares, each from where a ball
/// that comes down there touches it (touch offset). @param outward a normal per column.
/// @throws as pressure_law() of one node, for a triangle without any response.
[[nodiscard]] PressureLaw pressure_law(const ResponseTable& table,
                                       const std::array<std::int64_t, 3>& node,
                                       const Eigen::Vector3d& share,
                                       const Eigen::Matrix3d& outward);

}  // namespace palpate
