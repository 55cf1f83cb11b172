#include "runtime/fast/switch_model.h"

#include <algorithm>

namespace palpate {

void switch_model(FastState& state, LocalModel model) noexcept {
  if (model == state.config.model) {
    return;
  }
  PassivityLedger& ledger = state.ledger;
  if (!passive(state.config.model)) {
    // A held force stores F x, of any sign and size: what counts is the work put in.
    const double work_j = std::max<double>(0.0, ledger.work_j);
    ledger = {.work_j = work_j, .tank_j = work_j};
    state.safety.owed_j = 0.0;
    state.safety.dissipated_seen_j = 0.0;
  } else {
    book_change(ledger, 0.0, allowance_j(ledger));
  }
  // A needle is held by nothing any more, and by a model without a field never again.
  if (Channel* in =
          state.needle.active < 0
              ? nullptr
              : &state.needle.channel[static_cast<std::size_t>(state.needle.active)]) {
    let_go(*in);
    state.needle.active = -1;
  }
  state.config.puncture = is_field(model) ? state.config.puncture : PunctureRules{};
  state.config.model = model;
  state.element = {};
  state.potential = {};
  state.scalar = {};
  state.cache.pinned = -1;
  state.update_due = state.cache.newest_active >= 0;
}

}  // namespace palpate
