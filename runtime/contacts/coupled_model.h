// Several contacts as a local model: followed along the surface, each with its
// friction, kept passive by one ledger.
//
// The rules are those of one contact (potential_model.h), applied to the sum. While all
// places are sound, U is one function of the ports' poses, and the work of a tick is
// the change of U. Where a place is not sound (a late neighbour, a fold), its contact
// is continued in the tangent plane of the last tick. U is then that of the other
// contacts with the continued one. Where C had to be scaled (coupled_contacts.h), U is
// the last tick's energy less the work of its forces. What the field then is instead is
// a change that the ledger balances, by one delta_0 of all contacts. Friction springs
// are one per contact, with the force f_i that the others leave it.
//
// C that was scaled is whole again once nothing is touched.
//
// Where the surface remembers, U is u of coupled_field.h at frozen memory. A tick
// relaxes for half its time before the ports move and for half after
// (coupled_relaxation.h).
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/contacts/coupled_field.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/fast/friction_spring.h"
#include "runtime/memory/relaxing_bundle.h"

namespace palpate {

/// One contact in the latest tick.
struct CoupledContact {
  Vector3 centre_m = Vector3::Zero();  ///< [m] x_i
  FrictionSpring spring;
  ContactReading reading;
  std::uint64_t received_seen = 0;    ///< cache.received at the last tick
  std::uint64_t received_inside = 0;  ///< cache.received when last inside
};

/// What one bundle of a contact does in a step of relaxation.
struct BundleInStep {
  BundleStart start;
  TermValues share;  ///< [-] of its way that each term goes
  bool idle;         ///< nothing is remembered, and nothing presses
  std::array<TermValues, kSitesAtHand> site_n;  ///< [N] before, of what is not pressed
};

struct CoupledRelaxing {
  Real gathered_s = 0.0;        ///< [s] that have passed and are not spent yet
  std::uint64_t shortened = 0;  ///< steps cut because the account was short
  double shortened_j = 0.0;     ///< [J] >= 0 by which they would have exceeded it
  std::array<std::array<BundleInStep, kMemoryBundles>, kContactsMax> bundle;
};

/// About 2 MB.
struct CoupledModel {
  CoupledField field;
  CoupledRelaxing relaxing;
  std::array<CoupledContact, kContactsMax> contact;
  bool touching = false;  ///< some contact
  bool loaded = false;
};

/// Force and torque about a port's reference point, in the body's frame.
struct Wrench {
  Vector3 force_n = Vector3::Zero();
  Vector3 torque_n_m = Vector3::Zero();
};

using PortPoses = std::array<PortPose, kPortsMax>;
using PortWrenches = std::array<Wrench, kPortsMax>;

/// The first half of a tick's relaxing, before the ports move. @param half_s [s] half
/// the tick.
void relax_before(CoupledModel& model, CoupledField& scratch, const CoupledSet& set,
                  CoupledSurfaces surfaces, PassivityLedger& ledger,
                  Real half_s) noexcept;

/// The rest of the tick: books the work of the movement to `pose`, then changes the
/// model there.
/// @param scratch of the caller's, overwritten where places are not sound.
/// @param recovery_m_per_s [m/s] >= 0, at most which delta_0 sinks back.
/// @param dt_s [s] >= 0 of the tick.
/// @return on the ports, friction included.
PortWrenches advance(CoupledModel& model, CoupledField& scratch, const CoupledSet& set,
                     CoupledSurfaces surfaces, PassivityLedger& ledger,
                     const PortPoses& pose, Real recovery_m_per_s, Real dt_s) noexcept;

/// Puts the ports there as a change of the model, which the ledger balances: no work is
/// booked (coupled_step.h). @param scratch as above.
void carry(CoupledModel& model, CoupledField& scratch, const CoupledSet& set,
           CoupledSurfaces surfaces, PassivityLedger& ledger,
           const PortPoses& pose) noexcept;

/// Energy of the model with the ports moved there [J], before anything changes.
/// @param moved overwritten.
[[nodiscard]] Real moved_energy_j(const CoupledModel& model, CoupledModel& moved,
                                  CoupledField& scratch, const CoupledSet& set,
                                  CoupledSurfaces surfaces,
                                  const PortPoses& pose) noexcept;

/// Sum of F_i and of (x_i - position) x F_i by port.
[[nodiscard]] PortWrenches wrenches(const CoupledModel& model, const CoupledSet& set,
                                    const PortPoses& pose) noexcept;

}  // namespace palpate
