// The potential of section 5.2 of the paper: the curves of the active element at the
// fast rate, with friction.
//
// Symbols: x is the tool reference point (a sphere's centre), R its radius. x_c is the
// contact point in the active element, with area coordinates n_j (27). n is the outward
// surface normal and u = u_n the response direction there, both interpolated from the
// nodes (26). p = x - R n is the tool point. The depth is d = (x_c - p) . u (30). Node
// j is touched at t_j = touch_offset_j |n_j . u_j|; d_j = d - t_j - delta_0. k_t is the
// friction stiffness, delta_t the tangential part of p - x_c - q, q the slip that the
// ledger took.
//
// For fixed parameters the model is the potential
//
//   E(x) = sum_j n_j E_j(d_j) + k_t |delta_t|^2 / 2,   F = u sum_j n_j f_j - k_t
//   delta_t
//
// (28), (29). Where x_c has left the element and no neighbour is at hand, the element's
// plane is continued. Depth and friction are taken at the anchor a in that plane. The
// responses are taken at the point x_c of the element nearest to a ("a correct response
// at a wrong place"). Inside the element a = x_c.
//
// Where the surface remembers being pressed, sum n_j E_j is u of relaxing_contact.h at
// x_c, at frozen memory.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/cubic_cache.h"
#include "runtime/element/element_cache.h"
#include "runtime/element/prism.h"
#include "runtime/memory/relaxing_contact.h"

namespace palpate {

/// Parameters of the potential, constant between two changes.
struct ElementModel {
  int slot = -1;                          ///< element in the cache; -1: none, E = 0
  Prism prism;                            ///< of that element
  Matrix3 toward = Matrix3::Zero();       ///< [-] its u_j, one per column
  Vector3 area = Vector3::Zero();         ///< [-] n_j(x_c) >= 0, sum 1
  Vector3 direction = Vector3::Zero();    ///< [-] u; 0: no response
  Vector3 normal = Vector3::Zero();       ///< [-] n, unit
  Vector3 anchor_m = Vector3::Zero();     ///< [m] a, in the plane
  Vector3 anchor_area = Vector3::Zero();  ///< [-] of a; any sign, sum 1
  Vector3 rest_m = Vector3::Zero();       ///< [m] a + R n: x where d = 0
  Vector3 slip_m = Vector3::Zero();       ///< [m] q
  std::array<Real, 3> touch_m{};          ///< [m] t_j
  Real friction = 0.0;                    ///< [-] mu at x_c
  Real presliding_m = 0.0;                ///< [m] delta_L at x_c
  Real friction_n_per_m = 0.0;            ///< [N/m] k_t >= 0
  Real shift_m = 0.0;                     ///< [m] delta_0 >= 0
  bool outside = false;                   ///< a lies beyond the element's edges
  bool starved = false;  ///< outside, and the neighbour has not arrived
  CurvePieces pieces;
  RelaxingContact contact;            ///< at x_c, with the surface's memory
  std::uint64_t received_seen = 0;    ///< cache.received at the last step
  std::uint64_t received_inside = 0;  ///< cache.received when a was last inside
};

/// The potential and what it is made of, at one position of the tool.
struct ElementResponse {
  Real depth_m = 0.0;                      ///< [m] d
  bool touching = false;                   ///< some d_j + delta_0 > 0
  bool loaded = false;                     ///< some d_j > 0
  bool extrapolated = false;               ///< some d_j beyond its curve
  Real normal_n = 0.0;                     ///< [N] (28)
  Real stiffness_n_per_m = 0.0;            ///< [N/m] derivative of (28) with depth
  Real normal_j = 0.0;                     ///< [J] sum n_j E_j
  Real friction_j = 0.0;                   ///< [J] k_t |delta_t|^2 / 2
  Vector3 presliding_m = Vector3::Zero();  ///< [m] delta_t
  [[nodiscard]] Real potential_j() const noexcept { return normal_j + friction_j; }
};

/// Evaluates the potential at tool position x_m [m], where the surface's memory was
/// read at x_c. Of the model only what it keeps to evaluate the next one changes.
[[nodiscard]] ElementResponse respond_here(ElementModel& model,
                                           const ElementCache& cache,
                                           const Vector3& x_m) noexcept;

[[nodiscard]] ElementResponse respond(const ElementModel& model,
                                      const ElementCache& cache,
                                      const Vector3& x_m) noexcept;

/// Depth y of relaxing_contact.h with the tool at x_m [m].
[[nodiscard]] inline Real relaxing_depth_m(const ElementModel& model,
                                           const Vector3& x_m) noexcept {
  return (model.rest_m - x_m).dot(model.direction) - model.shift_m;
}

/// Reads the surface's memory at x_c. @param keep where what was at hand goes if
/// another element comes; null: nowhere.
void read_memory(ElementModel& model, const SurfaceMemory& memory, SurfaceMemory* keep,
                 const ElementCache& cache) noexcept;

/// Force on the tool [N] (29).
[[nodiscard]] Vector3 force_n(const ElementModel& model,
                              const ElementResponse& response) noexcept;

}  // namespace palpate
