#include "runtime/fast/relaxation_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpate {
namespace {

constexpr int kShortenMax = 40;
// Below this many times tau the exponential is its series.
constexpr Real kSoon = 0.01;
// How many times deeper than the contact a relaxed force's depth is looked for.
constexpr Real kDeepest = 8.0;
// An energy this small is rounding.
constexpr double kRoundingJ = rounding(1e-15, 1e-9);

std::size_t index(Eigen::Index i) {
  return static_cast<std::size_t>(i);
}

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

TermValues passed_shares(const SurfaceMemory& memory, Real time_s) {
  TermValues share = TermValues::Zero();
  for (Eigen::Index k = 0; k < memory.times.terms; ++k) {
    share(k) = passed(time_s * memory.times.rate_hz(k));
  }
  return share;
}

// Where a bundle's step began.
struct Start {
  bool pressed;  // goes towards target_n; else by itself
  bool touched;
  Real target_n;
  TermValues relaxed_n;
  Real carried_n;
  CurveInverse dent;
  Real energy_j;
};

struct Step {
  TermValues share;
  std::array<Start, kMemoryBundles> start;  // as many as there are bundles
};

Start start_of(const BundleContact& bundle) {
  return {.pressed = bundle.touched,
          .touched = bundle.touched,
          .target_n = std::max(bundle.at.force_n, bundle.memory.carried_n),
          .relaxed_n = bundle.memory.relaxed_n.value,
          .carried_n = bundle.memory.carried_n,
          .dent = bundle.dent,
          .energy_j = bundle.energy_j};
}

// Lets the sites of a bundle that is not touched go back. False, and nothing is
// changed, if the surface came up to the tool meanwhile.
bool recover(RelaxingContact& contact, const SurfaceMemory& memory, int bundle,
             Real time_s) {
  BundleContact& b = contact.bundle[index(bundle)];
  auto& forces = contact.sites.relaxed_n[index(bundle)];
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

// The blended forces of a pressed bundle after the step. @returns u.
Real press(RelaxingContact& contact, const ElementCache& cache, const Step& step,
           int bundle) {
  BundleContact& b = contact.bundle[index(bundle)];
  const Start& start = step.start[index(bundle)];
  TermValues& relaxed = b.memory.relaxed_n.value;
  relaxed = start.relaxed_n + step.share * (start.target_n - start.relaxed_n);
  b.memory.carried_n = carried_n(contact.sites, relaxed);
  b.solved = false;
  return set_energy(contact, cache, bundle);
}

// A step of one bundle. @returns by how much u rises.
Real advance(RelaxingContact& contact, const SurfaceMemory& memory,
             const ElementCache& cache, Step& step, int bundle, Real time_s) {
  BundleContact& b = contact.bundle[index(bundle)];
  Start& start = step.start[index(bundle)];
  start = start_of(b);
  if (!start.pressed) {
    if (!b.is_marked() || recover(contact, memory, bundle, time_s)) {
      return 0.0;
    }
    start.pressed = true;
  }
  return press(contact, cache, step, bundle) - start.energy_j;
}

// Back to where the step began.
void undo(RelaxingContact& contact, Step& step) {
  step.share.setZero();
  for (std::size_t b = 0; b < index(contact.nodes.bundles); ++b) {
    const Start& start = step.start[b];
    if (start.pressed) {
      BundleContact& bundle = contact.bundle[b];
      bundle.memory.relaxed_n.value = start.relaxed_n;
      bundle.memory.carried_n = start.carried_n;
      bundle.dent = start.dent;
      bundle.touched = bundle.solved = start.touched;
      bundle.energy_j = start.energy_j;
    }
  }
}

// The step for as much of its time as raises u by no more than paid_j.
Real shortened(RelaxingContact& contact, const SurfaceMemory& memory,
               const ElementCache& cache, Step& step, Real time_s, double paid_j) {
  const auto risen_j = [&](Real part) {
    step.share = passed_shares(memory, part * time_s);
    Real risen = 0.0;
    for (int b = 0; b < contact.nodes.bundles; ++b) {
      if (step.start[index(b)].pressed) {
        risen += press(contact, cache, step, b) - step.start[index(b)].energy_j;
      }
    }
    return risen;
  };
  Real low = 0.0;
  Real high = 1.0;
  for (int i = 0; i < kShortenMax; ++i) {
    const Real middle = 0.5 * (low + high);
    (double{risen_j(middle)} <= paid_j ? low : high) = middle;
  }
  const Real risen = low > 0.0 ? risen_j(low) : Real(0.0);
  if (low > 0.0 && double{risen} <= paid_j) {
    return risen;
  }
  undo(contact, step);
  return 0.0;
}

// Writes the step to the sites. @returns what it lost of u + V, to first order and not
// more.
double write(RelaxingContact& contact, const Step& step) {
  double lost = 0.0;
  for (int i = 0; i < contact.nodes.bundles; ++i) {
    BundleContact& b = contact.bundle[index(i)];
    const Start& start = step.start[index(i)];
    const YieldingPlace& yielded = contact.yielded;
    const Real from_m =
        yielded.elastic_depth_m(start.touched ? contact.depth_m : start.dent.depth_m);
    const TermValues went = b.memory.relaxed_n.value - start.relaxed_n;
    TermValues above;
    for (Eigen::Index k = 0; k < above.size(); ++k) {
      above(k) =
          std::max(Real(0.0),
                   (from_m - yielded.elastic_depth_m(b.relaxed_depth_m(k))) * went(k));
    }
    lost += double{
        (contact.sites.place_relaxing.value * (Real(1.0) - step.share) * above).sum()};
    if (start.pressed) {
      move_towards(contact.sites, i, start.relaxed_n, start.target_n, step.share,
                   b.memory.relaxed_n);
    }
  }
  return lost;
}

// delta(q_k) of a bundle, in the cubics of earlier places while they hold.
void follow_depths(RelaxingContact& contact, const SurfaceMemory& memory,
                   const ElementCache& cache, int bundle) {
  BundleContact& b = contact.bundle[index(bundle)];
  for (Eigen::Index k = 0; k < memory.times.terms; ++k) {
    const Real q = b.memory.relaxed_n.value(k);
    Real& depth = b.relaxed_depth_m(k);
    PlaceCubic& cubic = b.near_term[index(k)];
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

// V of a bundle.
double dent_j(RelaxingContact& contact, const SurfaceMemory& memory,
              const ElementCache& cache, int bundle) {
  BundleContact& b = contact.bundle[index(bundle)];
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
        elastic_j(contact, b, depth, b.near_term[index(k)].energy_at(depth));
    stored += contact.sites.place_relaxing.value(k) * std::max(Real(0.0), conjugate);
  }
  return double{std::max(Real(0.0), stored)};
}

// Books what the dent at hand stores.
void settle_dent(RelaxingContact& contact, const SurfaceMemory& memory,
                 PassivityLedger& ledger, const ElementCache& cache) {
  double holds_j = 0.0;
  ++contact.steps;
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    BundleContact& bundle = contact.bundle[index(b)];
    if (bundle.is_marked()) {
      // One at a time: V follows the place a little late.
      PlaceCubic& renewed = bundle.near_term[contact.steps % kMemoryTerms];
      renewed.high_m = renewed.low_m;
      follow_depths(contact, memory, cache, b);
      holds_j += dent_j(contact, memory, cache, b);
    }
  }
  book_dent(ledger, holds_j);
}

// Of what was left behind, some goes with the time: no dent goes back more slowly than
// at the rate (1 - sum g) / tau_K.
void recover_left(const SurfaceMemory& memory, const TermValues& relaxing,
                  PassivityLedger& ledger, Real time_s) {
  if (ledger.left_j > 0) {
    const Real stays = std::max(Real(0.0), Real(1.0) - relaxing.sum());
    const Real x = stays * time_s * memory.times.rate_hz(memory.times.terms - 1);
    book_recovery(ledger, double{x / (Real(1.0) + x)});
  }
}

}  // namespace

Real pass_time(SurfaceMemory& memory, Real half_s) noexcept {
  memory.gathered_s += half_s;
  if (memory.gathered_s * memory.times.rate_hz(0) < kGathered) {
    return 0.0;
  }
  return std::exchange(memory.gathered_s, Real(0.0));
}

void relax(RelaxingContact& contact, SurfaceMemory& memory, PassivityLedger& ledger,
           const ElementCache& cache, Real y_m, Real time_s) noexcept {
  if (contact.sites.time_s < memory.time_s) {
    read_memory(contact, memory, contact.place_weight, contact.place_turn);
    (void)respond(contact, cache, y_m);
  } else if (contact.tool_m != y_m) {
    (void)respond(contact, cache, y_m);
  }
  if (!(ledger.dent_j > 0.0) && ledger.left_j > 0.0) {
    settle_dent(contact, memory, ledger, cache);  // come back to
  }
  memory.time_s += static_cast<double>(time_s);
  contact.sites.time_s = memory.time_s;
  Step step;
  step.share = passed_shares(memory, time_s);
  Real risen_j = 0.0;
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    risen_j += advance(contact, memory, cache, step, b, time_s);
  }
  const double short_j = double{risen_j} - ledger.dent_j;
  if (short_j > kRoundingJ) [[unlikely]] {
    risen_j = shortened(contact, memory, cache, step, time_s, ledger.dent_j);
    ++memory.shortened;
    memory.shortened_j += short_j;
  } else if (short_j > 0) [[unlikely]] {
    undo(contact, step);
    risen_j = 0.0;
  }
  book_relaxing(ledger, double{risen_j}, write(contact, step));
  settle_dent(contact, memory, ledger, cache);
  recover_left(memory, contact.sites.place_relaxing.value, ledger, time_s);
}

void leave_alone(const RelaxingContact& contact, SurfaceMemory& memory,
                 PassivityLedger& ledger, Real time_s) noexcept {
  memory.time_s += double{time_s};
  book_dent(ledger, 0.0);
  recover_left(memory, contact.sites.place_relaxing.value, ledger, time_s);
}

}  // namespace palpate
