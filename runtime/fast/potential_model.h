// The potential field as a local model: followed along the surface, with friction, kept
// passive by the ledger.
//
// While the tool moves through elements at hand, nothing changes but the tool's place.
// The field is one function of that place, the work is U(x_{k+1}) - U(x_k), and the
// ledger has nothing to pay. The ledger has to pay where the field itself changes.
// Causes are a late neighbour, a fold of the coordinates, and another sheet of the body
// after a leap. Then what was rendered until that tick is, to first order in the
// tangent plane and exactly along the normal,
//
//   E(x) = max(0, sum_j w_j E_j(c_j (d - grad s . (x - x_k) - t_j - delta_0))
//                 - F_t . (x - x_k))
//
// (w_j, d, grad s and the tangential force F_t of the last tick x_k), and the new field
// is a change that the ledger balances.
//
// Friction is a spring in the tangent plane of x_k (friction_spring.h), which asks
// nothing of the ledger.
//
// Where the surface remembers (relaxing_contact.h), U is u at frozen memory. A tick
// relaxes for half its time before the tool moves and for half after.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/element/prism_walk.h"
#include "runtime/fast/element_model.h"
#include "runtime/fast/friction_spring.h"
#include "runtime/fast/potential_field.h"
#include "runtime/memory/relaxing_contact.h"
#include "runtime/memory/surface_memory.h"

namespace palpate {

/// Parameters of the field and of the friction spring, and the last tick.
struct PotentialModel {
  FieldPlace place;
  Real shift_m = 0.0;                ///< [m] delta_0 >= 0
  FrictionSpring spring;             ///< stretched by the tool
  Vector3 tool_m = Vector3::Zero();  ///< [m] x_k
  FieldResponse response;            ///< at x_k
  CurvePieces pieces;
  RelaxingContact contact;            ///< at x_k, with the surface's memory
  std::uint64_t received_seen = 0;    ///< cache.received at the last tick
  std::uint64_t received_inside = 0;  ///< cache.received when last inside
};

/// The first half of a tick's relaxing, before the tool moves. @param half_s [s] half
/// the tick.
void relax_before(PotentialModel& model, const ElementCache& cache,
                  SurfaceMemory& memory, PassivityLedger& ledger, Real tool_radius_m,
                  Real half_s) noexcept;

/// The rest of the tick: books the work of the movement to x_m, then changes the model
/// there. @param x_m finite. @return force on the tool [N], friction included.
Vector3 advance(PotentialModel& model, ElementCache& cache, SurfaceMemory& memory,
                PassivityLedger& ledger, const ElementModelLimits& limits,
                const Vector3& x_m, Real dt_s) noexcept;

/// The field is asked at another place, and the tool has not moved: a channel deepens,
/// is entered, or left. Nothing is booked. @param x_m finite.
void ask_at(PotentialModel& model, ElementCache& cache, SurfaceMemory& memory,
            Real tool_radius_m, const Vector3& x_m) noexcept;

/// Books the place that was asked last: what it holds less than what is stored is gone,
/// as yielded; what it holds more is paid.
void book_image(PotentialModel& model, ElementCache& cache, SurfaceMemory& memory,
                PassivityLedger& ledger, const ElementModelLimits& limits) noexcept;

/// Energy of the model with the tool moved to x_m [J], before anything changes.
[[nodiscard]] Real moved_energy_j(PotentialModel model, const ElementCache& cache,
                                  const SurfaceMemory& memory, Real tool_radius_m,
                                  const Vector3& x_m) noexcept;

}  // namespace palpate
