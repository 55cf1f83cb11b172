// What a tick of the fast step says beside its force: of one contact, or of several.
#pragma once

#include <cstdint>

#include "runtime/account/real.h"

namespace palpate {

struct TickAccount {
  bool in_contact = false;
  bool starved = false;  ///< a contact left its elements and the next had not arrived
  bool extrapolated = false;  ///< some contact is deeper than a curve was computed
  Real depth_m = 0.0;         ///< [m] of the deepest contact, along its direction
  double stored_j = 0.0;      ///< [J] potential of the local model
  double tank_j = 0.0;        ///< [J] >= 0
  double memory_j = 0.0;      ///< [J] >= 0, in dents of the surface
  Real carried_n = 0.0;       ///< [N] >= 0, what has relaxed of the normal forces
  double dissipated_j = 0.0;  ///< [J] >= 0, friction, relaxing, surplus, since start
  double yielded_j = 0.0;     ///< [J] >= 0, of that by yielding
  Real dent_m = 0.0;          ///< [m] >= 0 under a tool of one contact, that stays
  Real rest_offset_m = 0.0;   ///< [m] >= 0, delta_0 that the ledger had to take
  std::uint8_t fault = 0;     ///< Fault, latched; 0 none
};

}  // namespace palpate
