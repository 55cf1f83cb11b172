// Where the pressure of a linear contact acts, depth by depth, and what is stored of a
// contact.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "formats/response/contact_table.h"
#include "precompute/contact/contact_surface.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// Adds the states of an indentation's samples that bear force: the pressure's centre,
/// second moments, and exponent by its fourth moment (contact_table.h). A node's
/// pressure spreads over the node's hat.
/// @param patch, path as for indent().
void add_pressure_states(const ContactSurface& surface,
                         std::span<const std::int32_t> patch,
                         const IndentationPath& path, Indentation& indentation);

/// A value of the states around a penetration, linear in the root of the depth past the
/// touch: in a ball's contact radius. @param states at least one. @param value of a
/// state.
template <typename Value>
auto between_states(std::span<const PatchState> states, double touch_m,
                    double penetration_m, const Value& value) {
  const auto above = std::lower_bound(states.begin(), states.end(), penetration_m,
                                      [](const PatchState& state, double at) {
                                        return state.penetration_m < at;
                                      });
  if (above == states.begin()) {
    return value(states.front());
  }
  if (above == states.end()) {
    return value(states.back());
  }
  const PatchState& low = *(above - 1);
  const auto root = [&](double at_m) {
    return std::sqrt(std::max(0.0, at_m - touch_m));
  };
  const double t = (root(penetration_m) - root(low.penetration_m)) /
                   (root(above->penetration_m) - root(low.penetration_m));
  return decltype(value(low))(value(low) + t * (value(*above) - value(low)));
}

/// Of an indentation with samples past the touch, as it is stored: at shares of the
/// last sample's depth. The lateral part takes the stiffness dN/d(depth) of the
/// samples. Without states, or with samples that lose contact, it is empty.
[[nodiscard]] ContactTable stored_contact(const Indentation& indentation,
                                          const IndentationPath& path);

}  // namespace palpate
