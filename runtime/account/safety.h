// The last stage before the device: what may leave the fast step.
#pragma once

#include <cstdint>
#include <string_view>

#include <Eigen/Core>

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"

namespace palpate {

/// Why the force is zero for good. Latched: the first one stays.
enum class Fault : std::uint8_t {
  kNone = 0,
  kNotFinite = 1,     ///< a position, a response or a force was NaN or infinite
  kTimeStep = 2,      ///< dt negative, NaN or longer than a second
  kEnergy = 3,        ///< the account does not close, or the output created energy
  kSlowStalled = 4,   ///< raised outside: no element for too long
  kDeviceLost = 5,    ///< raised outside: transport failed
  kDeadlines = 6,     ///< raised outside: a burst of missed deadlines
  kDeviceSilent = 7,  ///< raised outside: no answer of the device for too long
  kJump = 8,          ///< raised outside: a position farther away than a hand moves
  kSlowWire = 9,  ///< raised outside: the wire holds forces too long, and gave energy
};

/// "none", "not-finite", "time-step", "energy", "slow-stalled", "device-lost",
/// "deadlines", "device-silent", "jump", "slow-wire"; "unknown" for a value that is no
/// Fault.
[[nodiscard]] std::string_view name(Fault fault) noexcept;

struct SafetyLimits {
  Real force_max_n = 10.0;         ///< [N] (0, inf] length of the force vector
  Real slew_max_n_per_s = 5000.0;  ///< [N/s] (0, inf] change of the force vector
  Real energy_floor_j = 0.01;  ///< [J] (0, inf] what the clamps' lag may have created
  Real ramp_s = 0.0;  ///< [s] [0, inf) from the start until force_max_n is allowed
};

/// @tparam kSize components: a force's three, or the wrenches of two ports.
template <int kSize>
struct BasicSafetyState {
  using Vector = Eigen::Matrix<Real, kSize, 1>;
  Vector force_n = Vector::Zero();      ///< [N] last that left
  Vector delivered_n = Vector::Zero();  ///< [N] what the device made of it
  Vector model_n = Vector::Zero();      ///< [N] last that was asked for
  double owed_j = 0.0;                  ///< [J] >= 0 given to the user beyond the model
  double dissipated_seen_j = 0.0;       ///< [J] the ledger's, at the last call
  Real age_s = 0.0;  ///< [s] since the start, as the steps counted it
  Fault fault = Fault::kNone;
};
using SafetyState = BasicSafetyState<3>;

/// Force and torque of two ports, the torques divided by a lever [N]; movements
/// likewise, turns times the lever [m]. The limits hold for the six of each port.
using WrenchSafety = BasicSafetyState<12>;

/// Latches a fault, unless one is latched already.
template <int kSize>
void raise_fault(BasicSafetyState<kSize>& state, Fault fault) noexcept {
  if (state.fault == Fault::kNone) {
    state.fault = fault;
  }
}

/// In order: finite check, force clamp (whole vector, direction kept), slew clamp,
/// energy check. From the start the clamp rises in proportion to time, to force_max_n
/// after ramp_s: a tool that starts inside a body is not thrown out. The energy check
/// holds the ledger's identity to rounding, and
///
///   stored + tank - owed >= -energy_floor,   owed <- max(0, owed + g - dissipated now)
///
/// with g = (force that was delivered - force of the model) . (movement of the tool
/// after it). stored + tank - owed is what the user has really put in and can still get
/// back. What clamps or a driver took from the user, and what friction took, pays for
/// what clamps and driver gave before. None of that is credit for later. Between any
/// two moments the user gets at most stored + tank of the first moment and the floor.
/// An infinite energy_floor omits the energy check, as the holds need, which create
/// energy.
/// @param wanted_n [N] the local model's force.
/// @param moved_m  [m] movement of the tool since the last call.
/// @param dt_s     [s] >= 0 since the last call; 0 leaves the force as it was.
/// @return the force for the device [N]; zero on any fault.
Vector3 make_safe(SafetyState& state, const SafetyLimits& limits,
                  const PassivityLedger& ledger, const Vector3& wanted_n,
                  const Vector3& moved_m, Real dt_s) noexcept;

WrenchSafety::Vector make_safe(WrenchSafety& state, const SafetyLimits& limits,
                               const PassivityLedger& ledger,
                               const WrenchSafety::Vector& wanted_n,
                               const WrenchSafety::Vector& moved_m, Real dt_s) noexcept;

}  // namespace palpate
