// What the fast thread shows of a needle to who looks on: the latest tick, for a
// picture.
#pragma once

#include "runtime/fast/needle_step.h"
#include "runtime/realtime/triple_buffer.h"

namespace palpate {

/// Written by the fast thread, read by one other.
using NeedleWatch = TripleBuffer<NeedleState>;

}  // namespace palpate
