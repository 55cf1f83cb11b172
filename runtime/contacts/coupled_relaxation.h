// Time passes for contacts that share a body which remembers (coupled_field.h).
//
// Proof that relaxing creates nothing, as that of one contact (relaxation_step.h) with
// vectors for numbers. U* is convex where the equilibrium is unique
// (coupled_contacts.h), U its conjugate in the places d_c of the surface under the
// contacts. The dents store V = sum g_k U*(q_k) - U*(s) >= 0, and
//
//   u + V = min over d_c >= d of [U(d_c) - s.d_c] + sum g_k U*(q_k).
//
// There the body's stress is p_0 = dU/dd_c = s + phi: with nothing borne it is s where
// a contact is lifted off. With p_0 of its beginning held through a step, every term
// g_k (U*(q_k) - d_c.q_k) is convex and has its least value at q_k = p_0. q_k moves
// straight towards p_0, all contacts by the same share. So u + V falls at fixed poses
// for a step of any length.
//
// So all contacts go by one clock. Three things are outside the proof. The first are
// contacts whose g_k or tau_k differ (there is no one U* then). The others are lifted
// contacts' exact way back, which is not straight, and tools that slid. The account
// holds whatever happens, because a rise of u is paid by what was booked as the dents'
// before. The account is short there at most; then the step is shortened for all
// contacts alike.
#pragma once

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/contacts/coupled_settle.h"

namespace palpate {

/// Half a tick passes where the tools are, in equilibrium: relaxes once enough time has
/// gathered, and books it and what the dents store then. Forces and flags of all
/// contacts are those after it.
void relax_here(const CoupledTick& t, PassivityLedger& ledger, Real half_s) noexcept;

}  // namespace palpate
