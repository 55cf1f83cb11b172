// A tool of several contacts, or two hands with one tool each, held by virtual
// couplings (virtual_coupling.h). The devices' poses go in, the wrenches of springs and
// dampers come out. A device then feels at most the coupling's spring, however stiff
// the body is. A tool turns under its contacts where the device cannot turn it.
//
//   CoupledState state{...};  couple(held, state, coupling);       // set-up
//   command = step(held, state, sample, dt);  delivered(held, state, wrench)
//
// The account of coupling and body together, at every tick:
//
//   work = (kinetic + springs + what the body stores) + tank + dents + dissipated
//
// The ports' tools move one after the other, so that each tick of each is one step of
// advance() in one potential. What the solver leaves of a tick's identity is never
// given to the hand. Missing energy counts as dissipated; energy that is too much is
// taken from the motion. Where the body is too stiff for the tool's mass, more may be
// left than the tool has. Then the account ends the run (fault "energy"). A tick longer
// than kVirtualTickMaxS is lived through that far: time that passes without a step
// needs no energy.
//
// On devices without torque output (torque_felt = false) a rotation takes tool and
// spring along. It is no work: it changes the body's model, and the account pays for
// that change (carry() of coupled_step.h).
#pragma once

#include <array>
#include <cstdint>

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/account/safety.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/contacts/virtual_coupling.h"

namespace palpate {

constexpr Real kVirtualTickMaxS = 0.002;
/// Readings that are nearer to each other count as so far apart for the dampers: noise
/// of a position a microsecond later is no velocity.
constexpr Real kVirtualTickMinS = 1e-4;

/// Of the coupling alone. All in J but the last.
struct VirtualToolAccount {
  double kinetic_j = 0.0;     ///< >= 0 in the tools' motion
  double spring_j = 0.0;      ///< >= 0
  double dissipated_j = 0.0;  ///< >= 0 by dampers, and what the solver lost
  double residual_j = 0.0;    ///< largest that the solver left of a tick
  double taken_j = 0.0;       ///< >= 0 of residuals, taken from the motion
  int iterations_max = 0;     ///< of a tick
};

/// About 2 MB.
struct VirtualTool {
  VirtualCoupling coupling;  ///< of every port
  bool torque_felt = true;   ///< the device pushes against turns
  SafetyLimits limits;       ///< of what leaves for the devices
  std::array<VirtualBody, kPortsMax> tool;
  std::array<DevicePose, kPortsMax> device;  ///< in the latest tick
  PortWrenches felt;  ///< of springs and dampers, before the limits
  bool begun = false;
  VirtualToolAccount account;
  PassivityLedger total;  ///< of coupling and body
  WrenchSafety safety;    ///< of what leaves
  CoupledModel moved;     ///< scratch
};

/// Takes over the limits of a state that is set up, whose own become none. Null if that
/// could be done, else one line on what is wrong. A coupling that is not valid is
/// wrong, and one whose tool is too light for ticks of kVirtualTickMaxS. A set with one
/// contact of one port is wrong, too.
[[nodiscard]] const char* couple(VirtualTool& held, CoupledState& state,
                                 const VirtualCoupling& coupling) noexcept;

/// One tick. @param sample of the devices. @return wrenches on the devices; stored_j,
/// dissipated_j of the whole account; faults as in coupled_step.h.
WrenchCommand step(VirtualTool& held, CoupledState& state, const PoseSample& sample,
                   Real dt_s) noexcept;

/// As delivered() of coupled_step.h.
void delivered(VirtualTool& held, const CoupledState& state,
               const PortWrenches& wrench) noexcept;

}  // namespace palpate
