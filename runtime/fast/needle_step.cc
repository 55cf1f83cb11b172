#include "runtime/fast/needle_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

// A root is found to this part of its force, or of the depth.
constexpr Real kRootShare = rounding(1e-9, 1e-4);
constexpr int kRootSteps = 60;

void ask_at(const PuncturedSurface& s, const Vector3& image_m) {
  ask_at(s.model, s.cache, s.memory, s.limits.tool_radius_m, image_m);
}

Real axial_n(const PuncturedSurface& s, const Channel& channel) {
  return channel.axis.dot(s.model.response.force_n);
}

// Deepens the channel, to most_m at the most, until the field's force is F_c or less.
// Secants within a bracket find the depth: the force falls as the image recedes. The
// model is asked there last.
void deepen(Real cutting_n, const PuncturedSurface& s, Channel& channel,
            const Vector3& x_m, Real most_m) {
  const auto excess_n = [&](Real depth_m) {
    channel.depth_m = depth_m;
    ask_at(s, channel.image_m(x_m));
    return axial_n(s, channel) - cutting_n;
  };
  // f(low) > F_c >= f(high)
  Real low_m = channel.depth_m, high_m = most_m;
  Real low_n = axial_n(s, channel) - cutting_n;
  Real high_n = excess_n(high_m);
  const Real enough_m = kRootShare * (high_m - low_m);
  for (int k = 0;
       k < kRootSteps && high_n < -kRootShare * cutting_n && high_m - low_m > enough_m;
       ++k) {
    const Real secant_m = high_m - high_n * (high_m - low_m) / (high_n - low_n);
    const Real next_m = k % 3 != 2 && secant_m > low_m && secant_m < high_m
                            ? secant_m
                            : Real(0.5) * (low_m + high_m);
    const Real next_n = excess_n(next_m);
    (next_n > 0.0 ? low_m : high_m) = next_m;
    (next_n > 0.0 ? low_n : high_n) = next_n;
  }
  if (channel.depth_m != high_m) {
    (void)excess_n(high_m);
  }
}

// The channel grows within its layer, at a fixed tip, until the force is F_c or the
// layer ends. Books crack and release.
void cut(const PunctureRules& rules, NeedleState& needle, const PuncturedSurface& s,
         Channel& channel, const Vector3& x_m) {
  const Real force_n = cutting_n(rules, channel);
  if (!(axial_n(s, channel) > force_n)) {
    return;
  }
  const Real before_j = s.model.response.energy_j;
  const Real before_m = channel.depth_m;
  const Real most_m = std::min(boundary_m(channel), channel.tip_m(x_m));
  if (!(most_m > before_m)) {
    return;
  }
  deepen(force_n, s, channel, x_m, most_m);
  const double freed_j = std::max<double>(0.0, before_j - s.model.response.energy_j);
  const double crack_j =
      std::min<double>(freed_j, force_n * (channel.depth_m - before_m));
  needle.crack_j += crack_j;
  needle.released_j += freed_j - crack_j;
  book_image(s.model, s.cache, s.memory, s.ledger, s.limits);
}

// Layer by layer, as far as the force reaches.
void flow(const PunctureRules& rules, NeedleState& needle, const PuncturedSurface& s,
          Channel& channel, const Vector3& x_m) {
  cut(rules, needle, s, channel, x_m);
  while (!(channel.depth_m < boundary_m(channel)) &&
         breaks(rules, channel, axial_n(s, channel), s.model.response.energy_j)) {
    ++channel.layer;
    ++needle.broken;
    channel.broke[static_cast<std::size_t>(channel.layer)] = {
        channel.tip_m(x_m),
        axial_n(s, channel) + channel.axis.dot(held_n(rules, channel))};
    cut(rules, needle, s, channel, x_m);
  }
}

// What a tip would meet below the place of the field: layers of the nearest node;
// depths and first rupture are interpolated where all nodes have the same layers.
NodePuncture layers_at(const PuncturedSurface& s) {
  const Element& element = element_of(s.cache, s.model.place.slot);
  const NodeValues weight = node_weights(s.model.place);
  Eigen::Index nearest = 0;
  weight.maxCoeff(&nearest);
  NodePuncture at = element.puncture[static_cast<std::size_t>(nearest)];
  const bool alike = std::all_of(
      element.puncture.begin(), element.puncture.end(), [&](const NodePuncture& node) {
        return node.layers == at.layers && node.material == at.material;
      });
  if (alike) {
    at.rupture = 0.0;
    at.depth_m = {};
    for (std::size_t j = 0; j < 3; ++j) {
      const Real part = weight(static_cast<Eigen::Index>(j));
      at.rupture += part * element.puncture[j].rupture;
      for (std::size_t k = 0; k < kPunctureLayers; ++k) {
        at.depth_m[k] += part * element.puncture[j].depth_m[k];
      }
    }
  }
  return at;
}

// A channel that a tip at x has found again; -1: none. A tip is in a channel where the
// channel is open and wide enough.
std::int32_t found_again(const PunctureRules& rules, const NeedleState& needle,
                         const Vector3& x_m) {
  for (std::int32_t i = 0; i < needle.channels; ++i) {
    const Channel& channel = needle.channel[static_cast<std::size_t>(i)];
    const Real tip_m = channel.tip_m(x_m);
    const Vector3 across = x_m - channel.entry_m + tip_m * channel.axis;
    if (tip_m > 0.0 && tip_m <= channel.depth_m && across.norm() <= rules.mouth_m) {
      return i;
    }
  }
  return -1;
}

// The first membrane breaks, if the field's force or energy reaches what it bears.
void puncture(const PunctureRules& rules, NeedleState& needle,
              const PuncturedSurface& s, const Vector3& x_m) {
  const FieldResponse& response = s.model.response;
  const FieldPlace& place = s.model.place;
  const Real force_n = response.force_n.norm();
  if (!response.loaded || place.slot < 0 || place.outside || place.folded ||
      !(force_n > 0.0)) {
    return;
  }
  const NodePuncture layers = layers_at(s);
  const Real reached = rules.by_energy ? response.energy_j : force_n;
  if (layers.layers == 0 || !(reached > layers.rupture)) {
    return;
  }
  if (needle.channels == kChannels) {
    ++needle.refused;
    return;
  }
  Channel channel;
  channel.axis = response.force_n / force_n;
  channel.entry_m = x_m + response.depth_m * channel.axis;
  channel.layers = layers;
  channel.broke[0] = {response.depth_m, force_n};
  needle.active = needle.channels++;
  needle.channel[static_cast<std::size_t>(needle.active)] = channel;
  ++needle.broken;
}

}  // namespace

Real moved_held_j(const PunctureRules& rules, const NeedleState& needle,
                  const Vector3& moved_m) noexcept {
  if (needle.active < 0) {
    return 0.0;
  }
  Channel channel = *channel_of(needle);
  move(channel, moved_m);
  return held_j(rules, channel);
}

Vector3 advance(const PunctureRules& rules, NeedleState& needle,
                const PuncturedSurface& s, const Vector3& field_n, const Vector3& x_m,
                const Vector3& moved_m, Real dt_s) noexcept {
  const bool was_in = needle.active >= 0;
  const auto before_j = static_cast<double>(held_j(rules, needle));
  if (!was_in) {
    needle.active = found_again(rules, needle, x_m);
    if (needle.active >= 0) {
      ask_at(s, image_m(needle, x_m));
      book_image(s.model, s.cache, s.memory, s.ledger, s.limits);
    } else {
      puncture(rules, needle, s, x_m);
    }
    if (needle.active < 0) {
      return field_n;
    }
  }
  Channel& channel = needle.channel[static_cast<std::size_t>(needle.active)];
  flow(rules, needle, s, channel, x_m);
  // The shaft: work at frozen limits, then what slips.
  const double field_j = s.ledger.stored_j;
  if (was_in) {
    move(channel, moved_m);
  }
  const auto moved_j = static_cast<double>(held_j(rules, channel));
  s.ledger.stored_j += before_j;
  book_work(s.ledger, field_j + moved_j);
  const Real tip_m = channel.tip_m(x_m);
  settle(rules, channel, tip_m, dt_s);
  if (tip_m < 0.0) {
    let_go(channel);
  }
  const auto now_j = static_cast<double>(held_j(rules, channel));
  needle.shaft_j += std::max<double>(0.0, moved_j - now_j);
  book_yielding(s.ledger, field_j + now_j);
  // The image moves along the axis alone: what acts across does no work.
  const Vector3 force_n =
      tip_n(channel, s.model) * channel.axis + held_n(rules, channel);
  if (tip_m < 0.0) {
    needle.active = -1;
    ask_at(s, x_m);
    book_image(s.model, s.cache, s.memory, s.ledger, s.limits);
    return s.model.response.force_n + s.model.spring.force_n();
  }
  return force_n;
}

}  // namespace palpate
