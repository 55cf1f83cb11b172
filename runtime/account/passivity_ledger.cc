#include "runtime/account/passivity_ledger.h"

#include <algorithm>

#include "runtime/account/real.h"

namespace palpate {
namespace {

// Less than this, relative and absolute, is rounding.
constexpr double kRoundingRelative = rounding(1e-12, 1e-6);
constexpr double kRoundingJ = 1e-15;

}  // namespace

void book_work(PassivityLedger& ledger, double potential_j) noexcept {
  ledger.work_j += potential_j - ledger.stored_j;
  ledger.stored_j = potential_j;
}

void note_shortfall(PassivityLedger& ledger, double wanted_j) noexcept {
  const double allowed = allowance_j(ledger);
  const double cut = wanted_j - allowed;
  if (cut > kRoundingJ + kRoundingRelative * allowed) {
    ++ledger.interventions;
    ledger.cut_j += cut;
  }
}

void book_change(PassivityLedger& ledger, double potential_j,
                 double tank_max_j) noexcept {
  const double left = allowance_j(ledger) - potential_j;
  ledger.stored_j = potential_j;
  ledger.created_j += std::max<double>(0.0, -left);
  ledger.tank_j = std::clamp<double>(left, 0.0, std::max<double>(0.0, tank_max_j));
  ledger.dissipated_j += std::max<double>(0.0, left - ledger.tank_j);
}

void book_relaxing(PassivityLedger& ledger, double risen_j, double lost_j) noexcept {
  ledger.stored_j += risen_j;
  const double left = ledger.dent_j - risen_j;
  ledger.created_j += std::max<double>(0.0, -left);
  const double lost = std::clamp<double>(lost_j, 0.0, std::max<double>(0.0, left));
  ledger.dent_j = std::max<double>(0.0, left - lost);
  ledger.dissipated_j += lost;
}

void book_yielding(PassivityLedger& ledger, double potential_j) noexcept {
  const double freed = ledger.stored_j - potential_j;
  ledger.stored_j = potential_j;
  ledger.created_j += std::max<double>(0.0, -freed);
  ledger.dissipated_j += std::max<double>(0.0, freed);
  ledger.yielded_j += std::max<double>(0.0, freed);
}

void book_dent(PassivityLedger& ledger, double holds_j) noexcept {
  const double over = ledger.dent_j - std::max<double>(0.0, holds_j);
  const double moved = std::max(over, -ledger.left_j);
  ledger.dent_j -= moved;
  ledger.left_j += moved;
}

void book_recovery(PassivityLedger& ledger, double share) noexcept {
  const double lost = share * ledger.left_j;
  ledger.left_j -= lost;
  ledger.dissipated_j += lost;
}

}  // namespace palpate
