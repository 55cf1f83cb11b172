#include "runtime/memory/relaxation_step.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "runtime/memory/relaxing_bundle.h"

namespace palpate {
namespace {

struct RelaxingStep {
  TermValues share;
  std::array<BundleStart, kMemoryBundles> start;  // as many as there are bundles
};

// A pressed bundle after the step. @returns u.
Real press(RelaxingContact& contact, const ElementCache& cache,
           const RelaxingStep& step, int bundle) {
  press(contact, step.start[array_index(bundle)], step.share, bundle);
  return set_energy(contact, cache, bundle);
}

// A step of one bundle. @returns by how much u rises.
Real bundle_step_j(RelaxingContact& contact, const SurfaceMemory& memory,
                   const ElementCache& cache, RelaxingStep& step, int bundle,
                   Real time_s) {
  const BundleContact& b = contact.bundle[array_index(bundle)];
  BundleStart& start = step.start[array_index(bundle)];
  start = start_of(contact, bundle);
  if (!start.pressed) {
    if (!b.is_marked() || recover(contact, memory, bundle, time_s)) {
      return 0.0;
    }
    start.pressed = true;
  }
  return press(contact, cache, step, bundle) - start.energy_j;
}

// Back to where the step began.
void undo(RelaxingContact& contact, RelaxingStep& step) {
  step.share.setZero();
  for (std::size_t b = 0; b < array_index(contact.nodes.bundles); ++b) {
    if (step.start[b].pressed) {
      undo(contact.bundle[b], step.start[b]);
    }
  }
}

// The step for as much of its time as raises u by no more than paid_j.
Real shortened(RelaxingContact& contact, const SurfaceMemory& memory,
               const ElementCache& cache, RelaxingStep& step, Real time_s,
               double paid_j) {
  const auto risen_j = [&](Real part) {
    step.share = passed_shares(memory, part * time_s);
    Real risen = 0.0;
    for (int b = 0; b < contact.nodes.bundles; ++b) {
      if (step.start[array_index(b)].pressed) {
        risen += press(contact, cache, step, b) - step.start[array_index(b)].energy_j;
      }
    }
    return risen;
  };
  // Halving for the largest part of the time whose rise of u is paid: it is at `low`.
  // The rise is not proportional to the time, so that no quotient gives it.
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
  // Nothing can be paid: the step is left out.
  undo(contact, step);
  return 0.0;
}

// Writes the step to the sites. @returns what it lost of u + V, to first order and not
// more.
double write_bundles(RelaxingContact& contact, const RelaxingStep& step) {
  double lost = 0.0;
  for (int i = 0; i < contact.nodes.bundles; ++i) {
    const BundleStart& start = step.start[array_index(i)];
    const TermValues above = way_down(contact, start, i).max(Real(0.0));
    lost += double{
        (contact.sites.place_relaxing.value * (Real(1.0) - step.share) * above).sum()};
    write_step(contact, start, step.share, i);
  }
  return lost;
}

// Books what the dent at hand stores.
void settle_dent(RelaxingContact& contact, const SurfaceMemory& memory,
                 PassivityLedger& ledger, const ElementCache& cache) {
  double holds_j = 0.0;
  ++contact.steps;
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    if (contact.bundle[array_index(b)].is_marked()) {
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
  // 1. The memory at hand is brought up to the surface's time, and the response to y.
  if (contact.sites.time_s < memory.time_s) {
    read_memory(contact, memory, contact.place_weight, contact.place_turn);
    (void)respond(contact, cache, y_m);
  } else if (contact.tool_m != y_m) {
    (void)respond(contact, cache, y_m);
  }
  // 2. Energy that was left behind in this dent pays for it again.
  if (!(ledger.dent_j > 0) && ledger.left_j > 0) {
    settle_dent(contact, memory, ledger, cache);  // come back to
  }
  // 3. The step: p_0 is held, every q_k moves towards it.
  memory.time_s += static_cast<double>(time_s);
  contact.sites.time_s = memory.time_s;
  RelaxingStep step;
  step.share = passed_shares(memory, time_s);
  Real risen_j = 0.0;
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    risen_j += bundle_step_j(contact, memory, cache, step, b, time_s);
  }
  // 4. u may rise by what the dent has; the step is shortened to that.
  const double short_j = double{risen_j} - ledger.dent_j;
  if (short_j > kShortJ) [[unlikely]] {
    risen_j = shortened(contact, memory, cache, step, time_s, ledger.dent_j);
    ++memory.shortened;
    memory.shortened_j += short_j;
  } else if (short_j > 0) [[unlikely]] {
    undo(contact, step);
    risen_j = 0.0;
  }
  book_relaxing(ledger, double{risen_j}, write_bundles(contact, step));
  settle_dent(contact, memory, ledger, cache);
  // 5. Energy of dents elsewhere goes with the time.
  recover_left(memory, contact.sites.place_relaxing.value, ledger, time_s);
}

void leave_alone(const RelaxingContact& contact, SurfaceMemory& memory,
                 PassivityLedger& ledger, Real time_s) noexcept {
  memory.time_s += double{time_s};
  book_dent(ledger, 0.0);
  recover_left(memory, contact.sites.place_relaxing.value, ledger, time_s);
}

}  // namespace palpate
