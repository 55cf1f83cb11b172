// Time passes for a contact with a surface that remembers, and for its account.
//
// Proof that relaxing creates nothing. The dent stores
// V = sum g_k U*(q_k) - U*(s) >= 0, and
// u + V = min over d_c >= y of [U(d_c) - s d_c] + sum g_k U*(q_k).
// With p_0 = max(p(y), s) of its beginning held through a step, every term
// g_k (U*(q_k) - d_c q_k) is convex. Its least value is at q_k = p_0, and q_k moves
// towards p_0. So u + V falls at a fixed place for a step of any length. Hence the
// potential rises by no more than V falls. The account gives the dent at most what V is
// (passivity_ledger.h), and pays for the rise. The account is short only where the tool
// has slid to a place whose dent stores more than was put into it. Then the step is
// shortened.
//
// A tick relaxes for half its time where the tool was, and moves at frozen q. The tick
// relaxes for the other half where the tool is now (Strang). The scheme is of second
// order, for any time. Time that is short against the shortest tau_k gathers before it
// is spent.
#pragma once

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/memory/relaxing_contact.h"
#include "runtime/memory/surface_memory.h"

namespace palpate {

/// Time that gathers before it is spent, over the shortest tau_k: what s may be late.
constexpr Real kGathered = 1.0 / 400.0;

/// Halvings that look for how much of a step the account can pay.
constexpr int kShortenMax = 40;

/// What the account is short of by no more than this is rounding [J].
constexpr double kShortJ = rounding(1e-15, 1e-9);

/// Half a tick passes where the tool is. @returns the time [s] that the surface relaxes
/// now: none, or all that has gathered.
[[nodiscard]] Real pass_time(SurfaceMemory& memory, Real half_s) noexcept;

/// Relaxes for time_s [s] at depth y [m] where the memory was read, and books it and
/// what the dent stores then. memory.time_s moves on by time_s.
void relax(RelaxingContact& contact, SurfaceMemory& memory, PassivityLedger& ledger,
           const ElementCache& cache, Real y_m, Real time_s) noexcept;

/// The same where there is nothing to relax: dents are left behind.
void leave_alone(const RelaxingContact& contact, SurfaceMemory& memory,
                 PassivityLedger& ledger, Real time_s) noexcept;

}  // namespace palpate
