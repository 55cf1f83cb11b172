// The account of energy that makes a changing local model passive.
//
// Between two changes the local model is a potential E_k(x), so the work that the user
// puts in is exactly E_k(x_{k+1}) - E_k(x_k) (paper, (14)). A change of the model at a
// fixed position costs E_{k+1}(x) - E_k(x). What a change frees goes into a tank, what
// it costs is paid from there; nothing is ever borrowed. Where the surface remembers
// being pressed (relaxing_contact.h), its dents hold energy, too. Energy of the dent
// under the tool pays for the recovery of that dent. Energy of dents left behind waits
// for the tool to come back, and goes as the dents do. At every moment
//
//   work = stored + tank + dent + left + dissipated      (all in J, all but work >= 0)
//
// hence work >= 0: passive (paper, (10)), whatever changed, when, and how late.
#pragma once

#include <cstdint>

namespace palpate {

struct PassivityLedger {
  double work_j = 0.0;        ///< [J] put in by the user since the start
  double stored_j = 0.0;      ///< [J] E_k(x_k), potential of the current model
  double tank_j = 0.0;        ///< [J] >= 0, freed by changes, may pay for others
  double dent_j = 0.0;        ///< [J] >= 0, in the dent under the tool
  double left_j = 0.0;        ///< [J] >= 0, in dents left behind
  double dissipated_j = 0.0;  ///< [J] >= 0, gone: friction, relaxing, discarded surplus
  double yielded_j = 0.0;     ///< [J] >= 0, of that by yielding
  double created_j = 0.0;     ///< [J] >= 0, held beyond the allowance; rounding only
  std::uint64_t interventions = 0;  ///< changes that had to be cut to the allowance
  double cut_j = 0.0;               ///< [J] >= 0, by which they were cut
};

/// The tool has moved under an unchanged model: books the work.
/// @param potential_j E_k(x_{k+1}) [J], current model at the new position.
void book_work(PassivityLedger& ledger, double potential_j) noexcept;

/// Most that a changed model may hold at the present position [J].
[[nodiscard]] inline double allowance_j(const PassivityLedger& ledger) noexcept {
  return ledger.stored_j + ledger.tank_j;
}

/// Counts a change that would hold wanted_j [J], where that is more than the allowance
/// and not rounding: an intervention. The caller cuts it, then books it.
void note_shortfall(PassivityLedger& ledger, double wanted_j) noexcept;

/// Books a change of the model at a fixed position: the only way to make one.
/// @param potential_j E_{k+1}(x) [J], the changed model, at most allowance_j(ledger).
/// @param tank_max_j  [J] the tank keeps at most this, the rest is dissipated.
void book_change(PassivityLedger& ledger, double potential_j,
                 double tank_max_j) noexcept;

/// Books relaxing at a fixed position. The dent pays what the potential rises by, or
/// takes up what it falls by; of the rest, lost_j are dissipated.
/// @param risen_j [J] of the potential, at most ledger.dent_j.
/// @param lost_j  [J] >= 0; no more than the dent has left is taken.
void book_relaxing(PassivityLedger& ledger, double risen_j, double lost_j) noexcept;

/// Books that the model has yielded at a fixed position (yield_step.h): what that frees
/// is gone.
/// @param potential_j [J] after it, at most what was stored.
void book_yielding(PassivityLedger& ledger, double potential_j) noexcept;

/// Books that the dent under the tool stores at most holds_j [J] >= 0: more is left
/// behind, less is taken back from there.
void book_dent(PassivityLedger& ledger, double holds_j) noexcept;

/// Books that of what is left behind so much goes as dents recover.
/// @param share [-] [0, 1].
void book_recovery(PassivityLedger& ledger, double share) noexcept;

/// Distance of the account from its identity [J]; rounding only, unless the ledger was
/// passed by.
[[nodiscard]] inline double imbalance_j(const PassivityLedger& ledger) noexcept {
  return ledger.work_j - (ledger.stored_j + ledger.tank_j + ledger.dent_j +
                          ledger.left_j + ledger.dissipated_j);
}

}  // namespace palpate
