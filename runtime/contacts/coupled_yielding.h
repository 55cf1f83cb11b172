// The surface yields under several contacts (yield_step.h).
//
// Each contact asks for what its own depth asks for, that which the others' dimples
// leave it. What yields lowers its elastic response at every depth. So the
// equilibrium's energy falls, which is a largest value over what the contacts bear
// (coupled_field.h). The energy freed is gone. Then all bear less and lie deeper, and
// ask again; what they still ask for after a few rounds they do at the next tick.
#pragma once

#include "runtime/account/passivity_ledger.h"
#include "runtime/contacts/coupled_settle.h"

namespace palpate {

/// Raises what has yielded under all contacts, in equilibrium, and books it. Forces and
/// flags of all contacts are those after it.
void yield_here(const CoupledTick& t, PassivityLedger& ledger) noexcept;

}  // namespace palpate
