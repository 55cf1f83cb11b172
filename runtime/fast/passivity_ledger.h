// The account of energy that makes a changing local model passive.
//
// Between two changes the local model is a potential E_k(x), so the work that the user
// puts in is exactly E_k(x_{k+1}) - E_k(x_k) (paper, (14)). A change of the model at a
// fixed position costs E_{k+1}(x) - E_k(x). What a change frees goes into a tank, what
// it costs is paid from there; nothing is ever lent. At every moment
//
//   work = stored + tank + dissipated      (all four in J, the last three >= 0)
//
// hence work >= 0: passive (paper, (10)), whatever changed, when, and how late.
#pragma once

#include <cstdint>

namespace palpate {

struct PassivityLedger {
  double work_j = 0.0;        ///< [J] put in by the user since the start
  double stored_j = 0.0;      ///< [J] E_k(x_k), potential of the current model
  double tank_j = 0.0;        ///< [J] >= 0, freed by changes, may pay for others
  double dissipated_j = 0.0;  ///< [J] >= 0, gone: friction and discarded surplus
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

/// Distance of the account from its identity, work - (stored + tank + dissipated) [J];
/// rounding only, unless the ledger was passed by.
[[nodiscard]] inline double imbalance_j(const PassivityLedger& ledger) noexcept {
  return ledger.work_j - (ledger.stored_j + ledger.tank_j + ledger.dissipated_j);
}

}  // namespace palpate
