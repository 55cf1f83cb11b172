// The surface yields under the tool: dents deepen, curves soften.
//
// Proof that yielding creates nothing. At a fixed place u of relaxing_contact.h falls
// with the dent, du/dD = -(p_e - s) <= 0 in contact. u falls with softening, too: less
// of every curve counts, and the dent's depth is where u is least. So whatever raises D
// and m at a place where the tool rests frees energy. The freed energy is booked as
// gone, none of it into the tank. Nothing ever lowers D and m. No rule of how much and
// at which sites enters the proof: where a site can take no more (yielded_sites.h), the
// place yields less.
//
// The rule: what a first press to the tool's depth would have left, D = r (y - Y) and
// m = y. D and m are written to the sites by their weights, and no site passes them.
// Sites that arrive leave the rest to the others, so no dent is deeper than its press.
#pragma once

#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/memory/relaxing_contact.h"
#include "runtime/memory/surface_memory.h"

namespace palpate {

/// Raises what has yielded, at hand and in the table, to what the contact's latest
/// response asks for. A raise that would cost energy, which only rounding can, is left.
/// @returns whether the response has changed; u has not risen then.
bool yield(RelaxingContact& contact, SurfaceMemory& memory,
           const ElementCache& cache) noexcept;

/// Takes what other contacts have written to the table that all share: nothing of it
/// ever falls, so that this costs no energy either. The response is that of before.
void take_yielded(RelaxingContact& contact, const SurfaceMemory& memory) noexcept;

}  // namespace palpate
