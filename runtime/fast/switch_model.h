// Another local model while the tool presses.
#pragma once

#include "runtime/fast/fast_step.h"

namespace palpate {

/// Renders by another model from the next step on. The old model's energy goes into the
/// tank, and the new model may take up no more than that. The new model's first
/// response is paid like any other change, so a switch creates no energy. After a hold,
/// which may have created some, the account begins anew with the work that was put in,
/// at least zero. Elements and faults stay.
void switch_model(FastState& state, LocalModel model) noexcept;

}  // namespace palpate
