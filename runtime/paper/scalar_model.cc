#include "runtime/paper/scalar_model.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Below this movement (20) divides by rounding.
constexpr Real kStillM = rounding(1e-9, 1e-7);

bool holds(const ScalarModel& model) {
  return !passive(model.kind);
}

Real held_force(const ScalarModel& m) {
  const bool extrapolates = m.kind == LocalModel::kFirstOrderHold && m.interval_s > 0.0;
  if (!extrapolates) {
    return m.latest.f_n;
  }
  const Real ahead = std::min(m.since_s / m.interval_s, 1.0);
  return std::max(0.0, m.latest.f_n + (m.latest.f_n - m.before.f_n) * ahead);
}

// (20), or 0 where it says nothing about the response. Where the tool has moved
// sideways, it is of two responses, and steeper than either: no stiffer than they are,
// so that what a held force gives is bounded as theirs is.
Real secant_stiffness(const SlowValue& before, const SlowValue& now) {
  const Real dx = now.x_m - before.x_m;
  const Real k = (now.f_n - before.f_n) / dx;
  const Real k_max = std::max(now.k_n_per_m, before.k_n_per_m);
  return std::abs(dx) > kStillM && k > 0.0 ? std::min(k, k_max) : 0.0;
}

void update_equal_energy(ScalarModel& model, PassivityLedger& ledger,
                         const SlowValue& slow) {
  const Real e = not_above(ledger.stored_j);  // E_{i-1}(x_i)
  if (slow.f_n > 0.0 && model.updates > 0) {
    const Real k = secant_stiffness(model.latest, slow);
    model.k_n_per_m = k > 0.0 ? k : model.k_n_per_m;
  } else if (!(e > 0.0)) {  // (24)
    model.k_n_per_m = 0.0;
  }
  // (22), equal to (23); also where k stays, because the axis may have turned.
  model.c_m = e > 0.0 ? slow.x_m - std::sqrt(2.0 * e / model.k_n_per_m) : slow.x_m;
  book_change(ledger, energy_j(model, slow.x_m), 0.0);
}

void update_energy_tank(ScalarModel& model, PassivityLedger& ledger,
                        const SlowValue& slow) {
  if (!(slow.f_n > 0.0) || !(slow.energy_j > 0.0)) {  // free space
    model.curve = {};
    book_change(ledger, 0.0, 0.0);
    return;
  }
  LocalCurve& curve = model.curve;
  curve = local_curve(slow);
  const Real allowed = not_above(allowance_j(ledger));
  note_shortfall(ledger, at(curve, slow.x_m).energy_j);
  lower(curve, allowed);
  book_change(ledger, at(curve, slow.x_m).energy_j, slow.energy_j);
}

}  // namespace

Real force_n(const ScalarModel& model, Real x_m) noexcept {
  if (holds(model)) {
    return held_force(model);
  }
  if (model.kind == LocalModel::kEnergyTank) {
    return at(model.curve, x_m).force_n;
  }
  return model.k_n_per_m * std::max(0.0, x_m - model.c_m);  // (19)
}

Real energy_j(const ScalarModel& model, Real x_m) noexcept {
  if (holds(model)) {
    return held_force(model) * x_m;
  }
  if (model.kind == LocalModel::kEnergyTank) {
    return at(model.curve, x_m).energy_j;
  }
  const Real stretch = std::max(0.0, x_m - model.c_m);
  return 0.5 * model.k_n_per_m * stretch * stretch;  // (21)
}

void advance(ScalarModel& model, PassivityLedger& ledger, Real x_m,
             Real dt_s) noexcept {
  book_work(ledger, energy_j(model, x_m));
  model.since_s += dt_s;
  if (model.kind == LocalModel::kFirstOrderHold) {
    book_change(ledger, energy_j(model, x_m), 0.0);
  }
}

void update(ScalarModel& model, PassivityLedger& ledger,
            const SlowValue& slow) noexcept {
  switch (model.kind) {
    case LocalModel::kEqualEnergy:
      update_equal_energy(model, ledger, slow);
      break;
    case LocalModel::kEnergyTank:
      update_energy_tank(model, ledger, slow);
      break;
    case LocalModel::kSingle:
    case LocalModel::kFirstOrderHold:
    case LocalModel::kElement:
    case LocalModel::kPotential:
    case LocalModel::kFacets:
      break;
  }
  // Slow values i and i - 1 of (20), and their distance in time for the first-order
  // hold.
  model.before = model.latest;
  model.latest = slow;
  model.interval_s = model.updates > 0 ? model.since_s : 0.0;
  model.since_s = 0.0;
  model.updates = std::min(model.updates + 1, 2);
  // Held forces have no allowance: what the new one stores, f x, is booked as it is.
  if (holds(model)) {
    book_change(ledger, energy_j(model, slow.x_m), 0.0);
  }
}

}  // namespace palpate
