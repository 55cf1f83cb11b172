// The fast step: one tick of passive rendering, from a tool position to a force.
//
// Bounded work; no allocation, lock, exception, system call or log. It could run on an
// embedded processor: the state is a plain struct of fixed size, elements come in by
// accept().
//
//   FastState state{.config = ...};                    // set-up; check(config) first
//   read device -> accept(state, element) for every message that arrived
//               -> command = step(state, sample, dt) -> write command.force_n
//               -> publish contact(state) for the slow process
//
// One thread owns a state; nothing here is shared.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/local_model.h"
#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/account/safety.h"
#include "runtime/account/tick_account.h"
#include "runtime/element/element.h"
#include "runtime/element/element_cache.h"
#include "runtime/fast/element_model.h"
#include "runtime/fast/needle_step.h"
#include "runtime/fast/potential_model.h"
#include "runtime/memory/surface_memory.h"
#include "runtime/paper/scalar_model.h"

namespace palpate {

struct FastConfig {
  LocalModel model = LocalModel::kElement;
  Real tool_radius_m = 0.0;        ///< [m] [0, inf) sphere; the others have 0
  Real force_max_n = 10.0;         ///< [N] (0, inf] length of the force vector
  Real slew_max_n_per_s = 5000.0;  ///< [N/s] (0, inf]
  Real energy_floor_j = 0.01;      ///< [J] (0, inf] what clamping may create
  Real recovery_m_per_s = 0.01;    ///< [m/s] [0, inf) how fast delta_0 is bled back
  /// [s] [0, inf) from the start until force_max_n, then finite, is allowed
  Real ramp_s = 0.0;
  PunctureRules puncture = {};  ///< of a needle, on a potential field alone
};

/// Null if the configuration is valid, else what is wrong with it, one line.
[[nodiscard]] const char* check(const FastConfig& config) noexcept;

/// What the device measured at one tick.
struct FastSample {
  Vector3 position_m = Vector3::Zero();  ///< [m] tool reference point
  std::int64_t time_ns = 0;              ///< [ns] monotonic clock
};

/// What the device is to do, and the account of this tick.
struct FastCommand : TickAccount {
  Vector3 force_n = Vector3::Zero();  ///< [N] on the tool; 0 on a fault
};

/// Where the fast process is: what it tells the slow one after a step.
struct FastContact {
  std::int64_t time_ns = 0;           ///< [ns] of the sample
  Vector3 tool_m = Vector3::Zero();   ///< [m] tool reference point, or its image
  Vector3 point_m = Vector3::Zero();  ///< [m] x_c
  Vector3 normal = Vector3::Zero();   ///< [-] there, outward unit; or 0
  std::int32_t triangle = -1;         ///< active triangle; -1 before the first
  bool in_contact = false;
  bool starved = false;
};

/// Where a contact is and what it bears, as the latest step left it.
struct ContactPlace {
  Vector3 centre_m = Vector3::Zero();  ///< [m]
  Vector3 point_m = Vector3::Zero();   ///< [m] on the surface at rest
  Vector3 normal = Vector3::Zero();    ///< [-] there, or 0
  Vector3 force_n = Vector3::Zero();   ///< [N] on the tool, friction included
  Real depth_m = 0.0;                  ///< [m] d_i
  Real dimple_m = 0.0;  ///< [m] of it what the others' forces and dents sink
  std::int32_t triangle = -1;
  Vector3 share = Vector3::Zero();  ///< [-] area coordinates of point_m; 0: not known
  bool touching = false;
  bool starved = false;
};

/// Everything the fast process remembers. About 430 kB, no pointers.
struct FastState {
  FastConfig config;
  ElementCache cache;
  ElementModel element;
  PotentialModel potential;
  ScalarModel scalar;       ///< along element.direction, from element.rest_m
  bool update_due = false;  ///< an active element came: scalar models update
  SurfaceMemory memory;
  NeedleState needle;
  bool relaxed_ahead = false;  ///< relax_ahead() has begun the coming tick
  PassivityLedger ledger;
  SafetyState safety;
  FastSample latest;
  bool sampled = false;  ///< `latest` holds a sample
  bool in_contact = false;
};

/// Whether every number of an element that is read is finite.
[[nodiscard]] bool is_finite(const Element& element) noexcept;

/// Takes in one element of the slow process. For the scalar models an element marked
/// active is the slow update. Its response at the next sample is the slow simulation's
/// value. The model goes on from that value until the next update. One with a number
/// that is not finite is not taken in: a fault.
void accept(FastState& state, const Element& element) noexcept;

/// Longest time since the last step [s]; beyond it a step is a fault.
constexpr Real kLongestStepS = 1.0;

/// One tick. A fault (safety.h) is latched and leaves zero force: a position that is
/// not finite, a dt that is negative, NaN or above kLongestStepS. dt 0 is allowed: the
/// model follows the sample, the force stays as it was.
/// @param dt_s [s] since the last step, [0, kLongestStepS].
FastCommand step(FastState& state, const FastSample& sample, Real dt_s) noexcept;

/// The part of a step() of dt_s that is done where the tool still is: half of what the
/// surface relaxes. step() does it where nobody did. Who accounts for the work of a
/// tick by potential_j() calls it first.
void relax_ahead(FastState& state, Real dt_s) noexcept;

/// Tells the account what the device made of the latest command, where its driver could
/// not render the whole command. Causes are motors that saturate, a pose without
/// transmission, and an exchange that was missed. Without a call the command counts as
/// rendered.
/// @param force_n [N] on the tool until the next step. A vector that is not finite
///   counts as the command.
void delivered(FastState& state, const Vector3& force_n) noexcept;

/// The contact point and active triangle after the latest step.
[[nodiscard]] FastContact contact(const FastState& state) noexcept;
/// Its triangle alone.
[[nodiscard]] std::int32_t active_triangle(const FastState& state) noexcept;

/// The same with all that it bears: for drawing.
[[nodiscard]] ContactPlace contact_place(const FastState& state) noexcept;

/// Potential of the present local model with the tool at x_m [J]. The work of a tick
/// is exactly potential_j(state, x_{k+1}) - potential_j(state, x_k), before step() and,
/// with a surface that remembers, after relax_ahead().
[[nodiscard]] Real potential_j(const FastState& state, const Vector3& x_m) noexcept;

/// Latches a fault that was found outside (stalled slow process, lost device, missed
/// deadlines): the force is zero from the next step on.
void raise_fault(FastState& state, Fault fault) noexcept;

}  // namespace palpate
