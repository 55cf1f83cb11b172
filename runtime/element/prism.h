// The space over and under one surface element, in coordinates of its own.
//
// A point x belongs to the contact point with area coordinates n_j and to the height s
// along the normal there:
//
//   x = p(n) + s n_out(n),   p = sum n_j v_j,   n_out = N / |N|,   N = sum n_j n_j^out
//
// Neighbouring elements agree on the face between their prisms, where the weight of the
// third corner is zero. So coordinates, and what is interpolated by them, are
// continuous. The map folds where s reaches the radius of curvature of the interpolated
// normals: under a convex place, or over a concave one. There `scale` reaches zero.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element.h"

namespace palpate {

/// What of an element fixes the map.
struct Prism {
  Matrix3 corner_m = Matrix3::Zero();  ///< [m] v_j, one per column
  Matrix3 normal = Matrix3::Zero();    ///< [-] n_j^out, one per column
  Real doubled_area_m2 = 0.0;          ///< [m^2] of the triangle
  Real size_m = 0.0;                   ///< [m] its square root
  bool flat = true;                    ///< no area to speak of: the map has no inverse
};

[[nodiscard]] Prism make_prism(const Element& element) noexcept;

/// Length of N below which normals have cancelled: it tells no direction.
constexpr Real kNoNormal = 1e-3;

/// Coordinates in a prism.
struct PrismPoint {
  Vector3 area = Vector3::Zero();  ///< [-] sum 1; any sign
  Real height_m = 0.0;             ///< [m] s, outside the body > 0
};

/// How the map goes on where an area coordinate is negative.
enum class Beyond : std::uint8_t {
  kAnalytic,  ///< by the same formula
  kHeld,      ///< p in the triangle's plane, all else as at its nearest point
};

/// The map and its derivatives at a point.
struct PrismFrame {
  Vector3 position_m = Vector3::Zero();  ///< [m] x
  Vector3 normal = Vector3::Zero();      ///< [-] n_out = dx/ds
  Vector3 along1_m = Vector3::Zero();    ///< [m] dx/dn_1, n_0 giving way
  Vector3 along2_m = Vector3::Zero();    ///< [m] dx/dn_2, likewise
  Vector3 cross_m2 = Vector3::Zero();    ///< [m^2] along1 x along2
  Vector3 weight = Vector3::Zero();      ///< [-] >= 0 if held; sum 1
  /// [-] dw/dn_1 and dw/dn_2, one per column.
  Eigen::Matrix<Real, 3, 2> turn = Eigen::Matrix<Real, 3, 2>::Zero();
  Vector3 bend1 = Vector3::Zero();   ///< [-] dn_out/dn_1
  Vector3 bend2 = Vector3::Zero();   ///< [-] dn_out/dn_2
  Vector2 growth = Vector2::Zero();  ///< [-] d ln|N| by n_1, n_2
  Real inverse_per_m2 = 0.0;         ///< [1/m^2] of the Jacobian's determinant
  Real scale = 0.0;  ///< [-] determinant over the triangle's; 0: no normal here
};

/// @param frame set whole.
void set_frame(const Prism& prism, const PrismPoint& at, Beyond beyond,
               PrismFrame& frame) noexcept;

[[nodiscard]] inline PrismFrame frame_at(const Prism& prism, const PrismPoint& at,
                                         Beyond beyond) noexcept {
  PrismFrame frame;
  set_frame(prism, at, beyond, frame);
  return frame;
}

/// Least scale of a frame in which coordinates are still taken for sound.
constexpr Real kScaleMin = 0.05;

enum class PrismSolve : std::uint8_t {
  kFound,
  kFolded,  ///< the way to x leads over a fold, or x has no coordinates here
};

/// One step of Newton's method: coordinates of the point r_m [m] away from the frame's.
/// @returns the largest change, of area coordinates and of the height over size_m [-].
Real newton_step(const PrismFrame& frame, const Vector3& r_m, Real size_m,
                 PrismPoint& at) noexcept;

/// Coordinates of the point r_m [m] away from the frame's to second order. Let
/// delta = J^-1 r and tau = d1 bend1 + d2 bend2. Then the map's second-order part is
/// taken off r: q = ds tau - s (d ln|N|) tau - s |tau|^2 n / 2.
void predict(const PrismFrame& frame, const Vector3& r_m, Real size_m,
             PrismPoint& at) noexcept;

/// Coordinates of x by Newton's method from `at`, which is left at the last estimate.
/// `frame` is that of the solution to 1e-7 (float: 1e-4) of the element's size, its
/// position x.
[[nodiscard]] PrismSolve find_coordinates(const Prism& prism, const Vector3& x_m,
                                          Beyond beyond, PrismPoint& at,
                                          PrismFrame& frame) noexcept;

/// Gradient at the frame's point [per m] of a function with these derivatives by n_1,
/// n_2 (n_0 compensating) and s [m].
[[nodiscard]] Vector3 gradient(const PrismFrame& frame, Real by_n1, Real by_n2,
                               Real by_s_per_m) noexcept;

}  // namespace palpate
