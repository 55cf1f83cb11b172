#include "runtime/needle/channel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate {
namespace {

const PunctureMaterial& material_of(const PunctureRules& rules, const Channel& channel,
                                    std::int32_t layer) {
  return rules.material[static_cast<std::size_t>(
      channel.layers.material[static_cast<std::size_t>(layer)])];
}

Real lateral_n_per_m(const PunctureRules& rules, Real inserted_m) {
  return rules.lateral_n_per_m2 * inserted_m;
}

bool is_force(Real value) {
  return value >= 0.0;
}  // infinite, too; no NaN

}  // namespace

const char* check(const PunctureRules& rules) noexcept {
  if (rules.materials < 0 || rules.materials > kPunctureMaterials) {
    return "a needle knows at most 8 materials";
  }
  if (rules.materials == 0) {
    return nullptr;
  }
  for (std::int32_t k = 0; k < rules.materials; ++k) {
    const PunctureMaterial& m = rules.material[static_cast<std::size_t>(k)];
    if (!is_force(m.membrane_n) || !is_force(m.cutting_n)) {
      return "forces of membranes and of cutting must not be negative";
    }
    if (!std::isfinite(m.membrane_j)) {
      return "energies of membranes must be finite";
    }
    if (!is_force(m.friction_n_per_m) || !std::isfinite(m.friction_n_per_m)) {
      return "friction of a shaft must be finite and not negative";
    }
    if (!(m.static_ratio >= 1.0) || !std::isfinite(m.static_ratio)) {
      return "static friction of a shaft must be at least the kinetic one";
    }
  }
  if (!(rules.shaft_n_per_m > 0.0) || !std::isfinite(rules.shaft_n_per_m)) {
    return "stiffness along a shaft must be finite and positive";
  }
  if (!(rules.lateral_n_per_m2 >= 0.0) || !std::isfinite(rules.lateral_n_per_m2)) {
    return "stiffness across a shaft must be finite and not negative";
  }
  if (!(rules.mouth_m > 0.0) || !std::isfinite(rules.mouth_m)) {
    return "the mouth of a channel must be finite and positive";
  }
  return nullptr;
}

Real cutting_n(const PunctureRules& rules, const Channel& channel) noexcept {
  return material_of(rules, channel, channel.layer).cutting_n;
}

Real boundary_m(const Channel& channel) noexcept {
  const std::int32_t next = channel.layer + 1;
  return next < channel.layers.layers
             ? channel.layers.depth_m[static_cast<std::size_t>(next)]
             : std::numeric_limits<Real>::infinity();
}

bool breaks(const PunctureRules& rules, const Channel& channel, Real force_n,
            Real energy_j) noexcept {
  const PunctureMaterial& next = material_of(rules, channel, channel.layer + 1);
  return next.membrane_j < 0.0 ? force_n > next.membrane_n : energy_j > next.membrane_j;
}

ShaftFriction friction_of(const PunctureRules& rules, const Channel& channel) noexcept {
  // Phi = sum_k phi_k (length of the shaft in layer k); static: rho_k phi_k.
  ShaftFriction sum;
  const Real inserted_m = channel.inserted_m;
  for (std::int32_t k = 0; k <= channel.layer; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Real from = k == 0 ? Real(0.0) : channel.layers.depth_m[i];
    const Real to = k == channel.layer ? inserted_m : channel.layers.depth_m[i + 1];
    const PunctureMaterial& material = material_of(rules, channel, k);
    const Real part_n = material.friction_n_per_m *
                        std::max(Real(0.0), std::min(to, inserted_m) - from);
    sum.kinetic_n += part_n;
    sum.static_n += material.static_ratio * part_n;
  }
  return sum;
}

Real held_j(const PunctureRules& rules, const Channel& channel) noexcept {
  return Real(0.5) *
         (rules.shaft_n_per_m * channel.shaft_m * channel.shaft_m +
          lateral_n_per_m(rules, channel.inserted_m) * channel.lateral_m.squaredNorm());
}

Vector3 held_n(const PunctureRules& rules, const Channel& channel) noexcept {
  return rules.shaft_n_per_m * channel.shaft_m * channel.axis -
         lateral_n_per_m(rules, channel.inserted_m) * channel.lateral_m;
}

void move(Channel& channel, const Vector3& moved_m) noexcept {
  const Real outward_m = channel.axis.dot(moved_m);
  channel.shaft_m -= outward_m;
  channel.lateral_m += moved_m - outward_m * channel.axis;
}

void settle(const PunctureRules& rules, Channel& channel, Real tip_m,
            Real dt_s) noexcept {
  const Real before_m = channel.inserted_m;
  channel.inserted_m = std::max(Real(0.0), std::min(tip_m, channel.depth_m));
  if (channel.inserted_m > before_m) {
    channel.lateral_m *= before_m / channel.inserted_m;  // K y stays
  }
  const auto [kinetic_n, static_n] = friction_of(rules, channel);
  const Real limit_n = channel.slips ? kinetic_n : static_n;
  if (rules.shaft_n_per_m * std::abs(channel.shaft_m) > limit_n) {
    channel.shaft_m = std::copysign(kinetic_n / rules.shaft_n_per_m, channel.shaft_m);
    channel.slips = true;
    channel.rested_s = 0.0;
  } else if (channel.slips) {
    channel.rested_s += dt_s;
    channel.slips = channel.rested_s < kShaftRestS;
  }
}

void let_go(Channel& channel) noexcept {
  channel.inserted_m = 0.0;
  channel.shaft_m = 0.0;
  channel.lateral_m.setZero();
  channel.slips = false;
  channel.rested_s = 0.0;
}

}  // namespace palpate
