#include "runtime/memory/relaxing_bundle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

// Below this many times tau the exponential is its series.
constexpr Real kSoon = 0.01;

// 1 - e^(-x), x >= 0.
Real passed(Real x) {
  constexpr std::array<Real, 5> kFactor{1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0,
                                        1.0 / 720.0};
  if (x < kSoon) {
    const auto& c = kFactor;
    return x * (1.0 - x * (c[0] - x * (c[1] - x * (c[2] - x * (c[3] - x * c[4])))));
  }
  return -std::expm1(-x);
}

// delta(q_k) of a bundle, in the cubics of earlier places while they hold.
void follow_depths(RelaxingContact& contact, const SurfaceMemory& memory,
                   const ElementCache& cache, int bundle) {
  BundleContact& b = contact.bundle[array_index(bundle)];
  for (Eigen::Index k = 0; k < memory.times.terms; ++k) {
    const Real q = b.memory.relaxed_n.value(k);
    Real& depth = b.relaxed_depth_m(k);
    PlaceCubic& cubic = b.near_term[array_index(k)];
    if (!(q > 0.0) || find_within(cubic, q, depth)) {
      continue;
    }
    const PlaceCurve curve = curve_of(contact, cache);
    const Real touch = first_touch_m(curve);
    const Real reach = std::max(depth, contact.depth_m) - touch;
    depth = search_inverse(curve, bundle, q, depth,
                           touch + kDeepest * std::max(Real(0.0), reach), cubic,
                           b.term_pieces)
                .depth_m;
  }
}

}  // namespace

TermValues passed_shares(const SurfaceMemory& memory, Real time_s) noexcept {
  TermValues share = TermValues::Zero();
  for (Eigen::Index k = 0; k < memory.times.terms; ++k) {
    share(k) = passed(time_s * memory.times.rate_hz(k));
  }
  return share;
}

BundleStart start_of(const RelaxingContact& contact, int bundle) noexcept {
  const BundleContact& b = contact.bundle[array_index(bundle)];
  return {.pressed = b.touched,
          .touched = b.touched,
          .depth_m = b.touched ? contact.depth_m : b.dent.depth_m,
          .target_n = std::max(b.at.force_n, b.memory.carried_n),
          .relaxed_n = b.memory.relaxed_n.value,
          .carried_n = b.memory.carried_n,
          .dent = b.dent,
          .energy_j = b.energy_j};
}

void press(RelaxingContact& contact, const BundleStart& start, const TermValues& share,
           int bundle) noexcept {
  BundleContact& b = contact.bundle[array_index(bundle)];
  TermValues& relaxed = b.memory.relaxed_n.value;
  relaxed = start.relaxed_n + share * (start.target_n - start.relaxed_n);
  b.memory.carried_n = carried_n(contact.sites, relaxed);
  b.solved = false;
}

bool recover(RelaxingContact& contact, const SurfaceMemory& memory, int bundle,
             Real time_s) noexcept {
  BundleContact& b = contact.bundle[array_index(bundle)];
  auto& forces = contact.sites.relaxed_n[array_index(bundle)];
  const auto before = forces;
  for (std::size_t i = 0; i < contact.sites.count; ++i) {
    forces[i] = recovered(memory, forces[i], contact.sites.relaxing[i], time_s);
  }
  const BlendedMemory after = blended(contact.sites, bundle);
  if (b.at.force_n > after.carried_n) {
    forces = before;
    return false;
  }
  b.memory = after;
  b.solved = false;
  return true;
}

void undo(BundleContact& bundle, const BundleStart& start) noexcept {
  bundle.memory.relaxed_n.value = start.relaxed_n;
  bundle.memory.carried_n = start.carried_n;
  bundle.dent = start.dent;
  bundle.touched = bundle.solved = start.touched;
  bundle.energy_j = start.energy_j;
}

TermValues way_down(const RelaxingContact& contact, const BundleStart& start,
                    int bundle) noexcept {
  const BundleContact& b = contact.bundle[array_index(bundle)];
  const YieldingPlace& yielded = contact.yielded;
  const Real from_m = yielded.elastic_depth_m(start.depth_m);
  const TermValues went = b.memory.relaxed_n.value - start.relaxed_n;
  TermValues down;
  for (Eigen::Index k = 0; k < down.size(); ++k) {
    down(k) = (from_m - yielded.elastic_depth_m(b.relaxed_depth_m(k))) * went(k);
  }
  return down;
}

void write_step(RelaxingContact& contact, const BundleStart& start,
                const TermValues& share, int bundle) noexcept {
  BundleContact& b = contact.bundle[array_index(bundle)];
  if (start.pressed) {
    move_towards(contact.sites, bundle, start.relaxed_n, start.target_n, share,
                 b.memory.relaxed_n);
  }
}

double dent_j(RelaxingContact& contact, const SurfaceMemory& memory,
              const ElementCache& cache, int bundle) noexcept {
  BundleContact& b = contact.bundle[array_index(bundle)];
  // One at a time: V follows the place a little late.
  PlaceCubic& renewed = b.near_term[contact.steps % kMemoryTerms];
  renewed.high_m = renewed.low_m;
  follow_depths(contact, memory, cache, bundle);
  const PlaceCurve curve = curve_of(contact, cache);
  const Real s = b.memory.carried_n;
  if (!b.solved) {
    const Real most = first_touch_m(curve) + kDeepest * std::abs(contact.depth_m);
    b.dent =
        inverse(curve, bundle, s, b.dent.depth_m, most, b.near_dent, b.dent_pieces);
  }
  const YieldingPlace& yielded = contact.yielded;
  Real stored = elastic_j(contact, b, b.dent.depth_m, b.dent.energy_j) -
                s * yielded.elastic_depth_m(b.dent.depth_m);
  for (Eigen::Index k = 0; k < memory.times.terms; ++k) {
    const Real q = b.memory.relaxed_n.value(k);
    const Real depth = b.relaxed_depth_m(k);
    const Real conjugate =
        q * yielded.elastic_depth_m(depth) -
        elastic_j(contact, b, depth, b.near_term[array_index(k)].energy_at(depth));
    stored += contact.sites.place_relaxing.value(k) * std::max(Real(0.0), conjugate);
  }
  return double{std::max(Real(0.0), stored)};
}

}  // namespace palpate
