// A needle in its channels, as the latest step left it: what hosts and pages are shown.
#pragma once

#include "runtime/fast/fast_step.h"
#include "runtime/realtime/triple_buffer.h"

namespace palpate {

/// Depths and forces are zero where the needle is in no channel. Forces are those of
/// the model, before any limit: together they are what is rendered where nothing is
/// limited.
struct NeedleSeen {
  bool punctures = false;  ///< else the tool is no needle
  NeedleState state;
  double tip_m = 0.0;       ///< [m] of the tip along the channel's axis; < 0: outside
  double inserted_m = 0.0;  ///< [m] of the shaft
  double tip_n = 0.0;       ///< [N] of the tissue before the tip, outward
  double shaft_n = 0.0;     ///< [N] along the shaft, outward
  Vector3 lateral_n = Vector3::Zero();  ///< [N] across
};

[[nodiscard]] NeedleSeen needle_seen(const FastState& state) noexcept;

/// Every tick's, written by the fast thread, read by one other.
using NeedleWatch = TripleBuffer<NeedleSeen>;

}  // namespace palpate
