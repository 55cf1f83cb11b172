// One tick of a tool with several contacts, or of two hands on one body: poses in,
// wrenches out. The counterpart of fast_step.h, with the same faults and limits.
//
//   check(set, config)                                       // set-up
//   CoupledState state{...};
//   accept(state, element) for every message that arrived
//   command = step(state, sample, dt)
//
// Bounded work; no allocation, lock, exception, system call or log. One thread owns a
// state. One contact of one port is rendered by step() of fast_step.h, bit for bit.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/account/safety.h"
#include "runtime/account/tick_account.h"
#include "runtime/contacts/coupled_field.h"
#include "runtime/contacts/coupled_model.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/fast/fast_step.h"

namespace palpate {

/// What the devices measured at one tick.
struct PoseSample {
  PortPoses pose;
  std::int64_t time_ns = 0;  ///< [ns] monotonic clock
};

/// What the devices are to do, and the account of this tick.
struct WrenchCommand : TickAccount {
  PortWrenches wrench;        ///< on the ports; 0 on a fault
  bool scaled = false;        ///< C is not whole (coupled_contacts.h)
  std::int32_t contacts = 0;  ///< that carry something
};

/// That of one contact: its force, on the first port.
[[nodiscard]] inline WrenchCommand as_wrench(const FastCommand& one) noexcept {
  WrenchCommand command;
  static_cast<TickAccount&>(command) = one;
  command.wrench[0].force_n = one.force_n;
  return command;
}

/// Everything a coupled fast process remembers, besides the surfaces. About 4 MB.
struct CoupledState {
  FastConfig config;  ///< model: kPotential; the tool's radius is the set's
  CoupledSet set;     ///< finished
  CoupledSurfaces surfaces = nullptr;  ///< (set.count), while the state lives
  FastState* alone = nullptr;          ///< for one contact of one port: renders it
  CoupledModel model;
  CoupledField scratch;
  PassivityLedger ledger;
  WrenchSafety safety;
  PoseSample latest;
  bool sampled = false;
  bool in_contact = false;
  bool relaxed_ahead = false;  ///< relax_ahead() has begun the coming tick
};

/// Finite, and its rotation is one (to 1e-6).
[[nodiscard]] bool is_sound(const PortPose& pose) noexcept;

/// Null if a state may begin with them, else what is wrong, one line.
[[nodiscard]] const char* check(const CoupledSet& set,
                                const FastConfig& config) noexcept;

/// Whether a set is rendered by `alone`: its owner provides one.
[[nodiscard]] inline bool is_alone(const CoupledSet& set) noexcept {
  return set.count == 1 && set.ports == 1;
}

/// The ledger that a state goes by.
[[nodiscard]] inline const PassivityLedger& account_of(
    const CoupledState& state) noexcept {
  return is_alone(state.set) ? state.alone->ledger : state.ledger;
}

/// Gives `alone` its configuration, and contacts with one table of responses one of
/// what has yielded; after config, set, surfaces and alone are set.
void begin(CoupledState& state) noexcept;

/// Forgets fault, account, places and what was sent; as after begin().
void restart(CoupledState& state) noexcept;

/// Takes in one element; one with a number that is not finite is a fault.
void accept(CoupledState& state, const ContactElement& message) noexcept;

/// Begins the coming tick: relaxes for the first half of its time where the tools are,
/// if that is not done yet. step() begins a tick by itself. Energies that are asked for
/// before a step, of the same dt_s, are those of its movement from here on.
void relax_ahead(CoupledState& state, Real dt_s) noexcept;

/// One tick. Faults as in fast_step.h; a rotation that is none (to 1e-6) counts as not
/// finite. @param dt_s [s] since the last step, [0, 1].
WrenchCommand step(CoupledState& state, const PoseSample& sample, Real dt_s) noexcept;

/// Puts the tools there before a step as a change of the model, not as work: turns that
/// a device measures and cannot push against. What the turned tools would store beyond
/// the allowance is taken by delta_0. So a hand gets nothing out of the axes that it
/// feels by turning in those that it does not. Nothing happens to a state with one
/// contact, or before the first step.
void carry(CoupledState& state, const PortPoses& pose) noexcept;

/// One tick of devices whose torques are not felt: what has turned since the last one
/// goes by carry(), what has moved by step().
WrenchCommand step_unturned(CoupledState& state, const PoseSample& sample,
                            Real dt_s) noexcept;

/// What the devices made of the latest command. @param wrench on the ports until the
/// next step.
void delivered(CoupledState& state, const PortWrenches& wrench) noexcept;

[[nodiscard]] ContactPlace contact_place(const CoupledState& state, int i) noexcept;

/// Potential of the present model with the ports moved there [J], as potential_j() of
/// fast_step.h. @param moved overwritten.
[[nodiscard]] Real potential_j(CoupledState& state, CoupledModel& moved,
                               const PortPoses& pose) noexcept;

void raise_fault(CoupledState& state, Fault fault) noexcept;

}  // namespace palpate
