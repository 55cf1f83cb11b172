// The potential field of a body: the energies of the stored curves, interpolated over
// the surface's elements.
//
// Symbols: w_j are the weights and s the height of the place. d = R - s is the normal
// penetration of a tool of radius R. Node j has the touch offset t_j, c_j = |n_j^out .
// u_j|, and the energy E_j of its stored curve. delta_0 >= 0 is the relaxed state.
//
//   U(x) = sum_j w_j E_j(c_j (d - t_j - delta_0)),    F = -grad U
//        = N grad s - sum_j E_j grad w_j,             N = sum_j w_j c_j f_j(...)
//
// Smooth (smooth_triangle.h): w and s have gradients that are continuous over the whole
// surface, and so has U: F has no steps. On the line of a node grad w vanishes, and
// grad s is the stored direction over its normal part. There F is the stored force at
// every depth. On facets (prism.h) w are area coordinates and s is the height over the
// flat element. There F steps across edges where slopes of the surface or of the
// responses do.
//
// A node without response counts as one of zero energy: U falls to zero towards it, and
// stays continuous. U >= 0, because w and E are.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/cubic_cache.h"
#include "runtime/element/element_cache.h"
#include "runtime/element/prism_walk.h"
#include "runtime/memory/relaxing_contact.h"

namespace palpate {

/// Energy, force and what they are made of, at one place and relaxed state.
struct FieldResponse {
  Real depth_m = 0.0;                 ///< [m] d
  bool touching = false;              ///< some d - t_j > 0
  bool loaded = false;                ///< some d - t_j - delta_0 > 0
  bool extrapolated = false;          ///< some node beyond its curve
  Real normal_n = 0.0;                ///< [N] N
  Real stiffness_n_per_m = 0.0;       ///< [N/m] its derivative with d
  Real energy_j = 0.0;                ///< [J] U
  Vector3 force_n = Vector3::Zero();  ///< [N] F, on the tool
};

/// A field that is one function changes by no more than kLeap times the force times the
/// movement, and kLeapJ [J]. A larger change is a leap to another sheet of the field.
constexpr Real kLeap = 4.0;
constexpr Real kLeapJ = rounding(1e-15, 1e-8);

/// @param pieces the cubic last used at each node; reused while the depth stays inside
/// it, else replaced.
[[nodiscard]] FieldResponse respond(const FieldPlace& place, const ElementCache& cache,
                                    Real tool_radius_m, Real shift_m,
                                    CurvePieces& pieces) noexcept;

/// The curves of the place's element, as its memory sees them.
[[nodiscard]] PlaceNodes place_nodes(const FieldPlace& place,
                                     const ElementCache& cache) noexcept;

/// Area coordinates of a point of the place's element.
[[nodiscard]] Vector3 shares_of(const FieldPlace& place,
                                const Vector3& point_m) noexcept;

/// w_j.
[[nodiscard]] NodeValues node_weights(const FieldPlace& place) noexcept;

/// Reads the surface's memory at the place; above the surface there is none to feel.
/// @param keep where what was at hand goes if another element comes; null: nowhere.
void read_memory(RelaxingContact& contact, const SurfaceMemory& memory,
                 SurfaceMemory* keep, const FieldPlace& place,
                 const ElementCache& cache, Real tool_radius_m) noexcept;

/// The response of a surface that remembers along the normal: u of relaxing_contact.h
/// at depth y = d - delta_0. `touching` is where the tool would be past the dent
/// without delta_0, `loaded` where it is. force_n is without its part along the
/// surface.
/// @param contact whose memory was read at the place.
[[nodiscard]] FieldResponse respond(const FieldPlace& place, const ElementCache& cache,
                                    Real tool_radius_m, Real shift_m,
                                    RelaxingContact& contact) noexcept;

/// The same, for a response that is known.
[[nodiscard]] FieldResponse field_response(const FieldPlace& place,
                                           const ElementCache& cache,
                                           Real tool_radius_m, Real shift_m,
                                           const RelaxingContact& contact,
                                           const RelaxedResponse& relaxed) noexcept;

/// F = -grad u of the latest response.
[[nodiscard]] Vector3 whole_force_n(const FieldPlace& place, const ElementCache& cache,
                                    RelaxingContact& contact,
                                    const FieldResponse& response) noexcept;

/// Largest penetration at which nothing is loaded, d - min t_j over the nodes that
/// count; delta_0 from there on gives U = 0.
[[nodiscard]] Real unloading_shift_m(const FieldPlace& place, const ElementCache& cache,
                                     Real tool_radius_m) noexcept;

}  // namespace palpate
