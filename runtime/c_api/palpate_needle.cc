// The C interface's needle: nothing here allocates, locks or throws.
#include "runtime/c_api/palpate_needle.h"

#include <cmath>
#include <cstddef>

#include "runtime/c_api/guarded.h"
#include "runtime/c_api/host_handles.h"
#include "runtime/c_api/known_struct.h"

namespace {

using palpate::copy_vector;

// PALPATE_ERROR_INPUT where a call is wrong, and why; else 0.
int refusal(const palpate_tool* tool, bool given, char* error,
            std::size_t error_bytes) noexcept {
  const char* why = "";
  if (tool == nullptr || !given) {
    why = "no tool, no room, or no size of the struct: a pointer is null or a size 0";
  } else if (!tool->tool.needle().punctures) {
    why = palpate::kNoNeedle;
  }
  palpate::copy_text(why, error, error_bytes);
  return *why == '\0' ? 0 : PALPATE_ERROR_INPUT;
}

palpate_channel channel_of(const palpate_tool& tool, std::int32_t i) noexcept {
  const palpate::Channel channel = tool.tool.channel_at(i);
  const double boundary_m = palpate::boundary_m(channel);
  palpate_channel one{};
  copy_vector(channel.entry_m, tool.metres_per_unit, one.entry);
  copy_vector(channel.axis, 1.0, one.axis);
  one.depth = channel.depth_m / tool.metres_per_unit;
  one.layer = channel.layer;
  one.layers = channel.layers.layers;
  one.boundary = std::isfinite(boundary_m) ? boundary_m / tool.metres_per_unit : 0.0;
  return one;
}

}  // namespace

int palpate_needle_get(const palpate_tool* tool, palpate_needle* needle, char* error,
                       size_t error_bytes) {
  const bool given = needle != nullptr && needle->struct_size >= sizeof(size_t);
  if (const int wrong = refusal(tool, given, error, error_bytes)) {
    return wrong;
  }
  const palpate::NeedleSeen seen = tool->tool.needle();
  palpate_needle all{};
  all.struct_size = needle->struct_size;
  all.channels = seen.state.channels;
  all.channel = seen.state.active;
  all.broken = seen.state.broken;
  all.refused = seen.state.refused;
  all.tip_depth = seen.tip_m / tool->metres_per_unit;
  all.inserted = seen.inserted_m / tool->metres_per_unit;
  all.tip_force = seen.tip_n / tool->newtons_per_unit;
  all.shaft_force = seen.shaft_n / tool->newtons_per_unit;
  copy_vector(seen.lateral_n, tool->newtons_per_unit, all.lateral_force);
  all.cut_j = seen.state.crack_j;
  all.released_j = seen.state.released_j;
  all.shaft_j = seen.state.shaft_j;
  palpate::copy_known(all, needle);
  return 0;
}

int palpate_channels_get(const palpate_tool* tool, palpate_channel* channels,
                         size_t room, size_t channel_bytes, char* error,
                         size_t error_bytes) {
  const bool given =
      (room == 0 || channels != nullptr) && channel_bytes >= sizeof(size_t);
  if (const int wrong = refusal(tool, given, error, error_bytes)) {
    return wrong;
  }
  const std::int32_t count = tool->tool.needle().state.channels;
  for (std::int32_t i = 0; i < count && static_cast<size_t>(i) < room; ++i) {
    palpate::copy_row(channel_of(*tool, i), channels, static_cast<size_t>(i),
                      channel_bytes);
  }
  return count;
}
