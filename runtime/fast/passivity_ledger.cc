#include "runtime/fast/passivity_ledger.h"

#include <algorithm>

namespace palpate {

void book_work(PassivityLedger& ledger, double potential_j) noexcept {
  ledger.work_j += potential_j - ledger.stored_j;
  ledger.stored_j = potential_j;
}

void book_change(PassivityLedger& ledger, double potential_j,
                 double tank_max_j) noexcept {
  const double left = allowance_j(ledger) - potential_j;
  ledger.stored_j = potential_j;
  ledger.created_j += std::max(0.0, -left);
  ledger.tank_j = std::clamp(left, 0.0, std::max(0.0, tank_max_j));
  ledger.dissipated_j += std::max(0.0, left - ledger.tank_j);
}

}  // namespace palpate
