// The local model of section 5.2 of the paper: the element potential, moved along the
// surface with the tool and made passive by the ledger.
#pragma once

#include <Eigen/Core>

#include "runtime/account/local_model.h"
#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/fast/element_potential.h"
#include "runtime/memory/surface_memory.h"

namespace palpate {

struct ElementModelLimits {
  Real tool_radius_m = 0.0;              ///< [m] R >= 0
  Real recovery_m_per_s = 0.01;          ///< [m/s] >= 0, how fast delta_0 is bled back
  FieldKind field = FieldKind::kSmooth;  ///< of the potential model
};

/// The first half of a tick's relaxing, with the tool still at x_m. @param half_s [s]
/// half the tick.
void relax_before(ElementModel& model, const ElementCache& cache, SurfaceMemory& memory,
                  PassivityLedger& ledger, const Vector3& x_m, Real half_s) noexcept;

/// The rest of the tick. Books the work of the movement to x_m, then changes the model
/// there by way of the ledger. Changes are a new element, sliding, k_t, recovery of
/// delta_0, and the other half of what the surface relaxes. What the allowance does not
/// cover is taken from the friction spring first (the anchor slips, (23)), then by
/// raising delta_0.
/// @param x_m finite. @return the response of the changed model at x_m.
ElementResponse advance(ElementModel& model, ElementCache& cache, SurfaceMemory& memory,
                        PassivityLedger& ledger, const ElementModelLimits& limits,
                        const Vector3& x_m, Real dt_s) noexcept;

}  // namespace palpate
