// A needle on the potential field: it punctures, cuts, is held by its channel, and
// finds channels again (needle/channel.h).
//
// A tick has three parts. The field's place moves to the image of the tip. The channel
// deepens, at a fixed tip. The shaft moves and slips.
//
//   seen = image_m(needle, x);   advance(potential model, seen);
//   force = advance(rules, needle, potential model, .., x, ..);
//
// A tip without a channel has its image where it is. So before a puncture nothing
// differs from a tool that is no needle.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/fast/element_model.h"
#include "runtime/fast/potential_model.h"
#include "runtime/memory/surface_memory.h"
#include "runtime/needle/channel.h"

namespace palpate {

/// Channels of a body, and the needle in one of them.
struct NeedleState {
  std::array<Channel, kChannels> channel;
  std::int32_t channels = 0;
  std::int32_t active = -1;   ///< channel that the needle is in; -1: none
  std::uint64_t broken = 0;   ///< membranes
  std::uint64_t refused = 0;  ///< ticks in which a puncture found no free channel
  double crack_j = 0.0;       ///< [J] >= 0 spent on new surface, F_c dL
  double released_j = 0.0;    ///< [J] >= 0 that ruptures set free beyond that
  double shaft_j = 0.0;       ///< [J] >= 0 dissipated along and across the shaft
};

/// The channel that the needle is in; null: none.
[[nodiscard]] inline const Channel* channel_of(const NeedleState& needle) noexcept {
  return needle.active < 0 ? nullptr
                           : &needle.channel[static_cast<std::size_t>(needle.active)];
}

/// Where the field is asked for a tip at x.
[[nodiscard]] inline Vector3 image_m(const NeedleState& needle,
                                     const Vector3& x_m) noexcept {
  const Channel* in = channel_of(needle);
  return in == nullptr ? x_m : in->image_m(x_m);
}

/// What the tissue before the tip gives along the axis [N], outward.
[[nodiscard]] inline Real tip_n(const Channel& channel,
                                const PotentialModel& at_image) noexcept {
  return channel.axis.dot(
      Vector3(at_image.response.force_n + at_image.spring.force_n()));
}

/// Energy that the needle's shaft holds [J].
[[nodiscard]] inline Real held_j(const PunctureRules& rules,
                                 const NeedleState& needle) noexcept {
  const Channel* in = channel_of(needle);
  return in == nullptr ? Real(0.0) : held_j(rules, *in);
}

/// The same with the tip moved, before anything changes.
[[nodiscard]] Real moved_held_j(const PunctureRules& rules, const NeedleState& needle,
                                const Vector3& moved_m) noexcept;

/// The surface that a needle is pressed into, as potential_model.h's functions take it.
struct PuncturedSurface {
  PotentialModel& model;
  ElementCache& cache;
  SurfaceMemory& memory;
  PassivityLedger& ledger;
  ElementModelLimits limits;
};

/// The rest of a tick, after the model has advanced to the image. The ledger's stored
/// energy is the model's alone then, and model and shaft's afterwards.
/// @param field_n [N] of the model at the image, friction of its surface included.
/// @param moved_m [m] of the tip since the last tick.
/// @return force on the tool [N].
Vector3 advance(const PunctureRules& rules, NeedleState& needle,
                const PuncturedSurface& surface, const Vector3& field_n,
                const Vector3& x_m, const Vector3& moved_m, Real dt_s) noexcept;

}  // namespace palpate
