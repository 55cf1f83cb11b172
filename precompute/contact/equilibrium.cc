#include "precompute/contact/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

// Directions that the preconditioner remembers, each with three vectors over the near
// unknowns.
constexpr std::size_t kMostKnown = 24;
// Conjugate gradients of a step that cost more than a factor that saves most of them.
constexpr std::size_t kManyGradients = 8;
// [-] An element's volume over its volume at rest may become this share of the least
// one within a step. Nearer to zero, forces grow beyond what a step can be computed
// from.
constexpr double kThinner = 0.2;
// A start is too far away after so many steps of which less than this share keeps
// elements from turning inside out, while the energy that they promise is above this
// share of the elastic energy.
constexpr int kMostCreeping = 3;
constexpr double kCreeping = 0.02;
constexpr double kFarFromRest = 0.1;

void add(NearState& to, double factor, const NearState& other) {
  to.source_n += factor * other.source_n;
  to.displacement_m += factor * other.displacement_m;
}

}  // namespace

ElementBatches::Energy Equilibrium::elastic(const NearState& state) const {
  ElementBatches::Energy energy = near_.excess(state.displacement_m);
  energy.energy_j += 0.5 * state.source_n.dot(state.displacement_m);
  return energy;
}

// K^-1 corrected by directions of earlier tangents: the inverse update of limited
// memory (Morales and Nocedal 2000), which keeps the pair (s, K^-1 s).
NearState Equilibrium::preconditioned(const Eigen::VectorXd& r) const {
  // Known directions p_i with q_i = H p_i and rho_i = 1 / (p_i . q_i). Two loops: first
  // a_i = rho_i p_i . r, r -= a_i q_i, from the newest. Then z = K^-1 r and z += (a_i -
  // rho_i q_i . z) p_i, from the oldest.
  Eigen::VectorXd rest = r;
  std::vector<double> along(known_.size());
  for (std::size_t i = known_.size(); i-- > 0;) {
    along[i] = known_[i].inverse_curvature * known_[i].along.displacement_m.dot(rest);
    rest -= along[i] * known_[i].change_n;
  }
  NearState z;
  if (tangent_ != nullptr && tangent_->ready()) {
    z = tangent_->solve(rest);
  } else {
    z.displacement_m = solve_(near_.dof(), rest, SolveWith::kRounded);
    z.source_n = std::move(rest);
  }
  for (std::size_t i = 0; i < known_.size(); ++i) {
    const double already =
        known_[i].inverse_curvature * known_[i].change_n.dot(z.displacement_m);
    add(z, along[i] - already, known_[i].along);
  }
  return z;
}

// Directions of earlier tangents may hide others in which the body is not at rest.
void Equilibrium::forget_tangents() {
  known_.clear();
  if (tangent_ != nullptr) {
    tangent_->drop();
  }
}

void Equilibrium::learn(std::vector<KnownDirection> directions) {
  std::move(directions.begin(), directions.end(), std::back_inserter(known_));
  while (known_.size() > kMostKnown) {
    known_.pop_front();
  }
}

// A tangent that is close to singular is factored with large errors, and pairs that it
// makes would leave the far field out of balance. False where that is so.
bool Equilibrium::pair_exactly(NearState& direction) const {
  constexpr double kRounding = 1e-6;
  const Eigen::VectorXd made = std::move(direction.displacement_m);
  direction.displacement_m =
      solve_(near_.dof(), direction.source_n, SolveWith::kFactor);
  return (made - direction.displacement_m).norm() <=
         kRounding * direction.displacement_m.norm();
}

// In the pair (s, K^-1 s) neither K nor its far part is ever applied: K p = s_p.
NearState Equilibrium::conjugate_gradients(Eigen::VectorXd r,
                                           EquilibriumReport& report) {
  const Eigen::Index n = near_.size();
  const double tolerance = options_.gradient_tolerance * options_.gradient_tolerance;
  NearState direction{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  NearState p;
  double rz = 0.0;
  double enough = 0.0;
  double gain = 0.0;  // of energy, by all gradients
  double last_gain = 0.0;
  std::vector<KnownDirection> learnt;
  for (int i = 0; i < options_.gradients_max; ++i) {
    NearState z = preconditioned(r);
    ++report.gradients;
    const double rz_new = r.dot(z.displacement_m);
    // Where the preconditioner is close to singular the residual's norm is that of one
    // direction, and the energy still to be gained, about what the last one gained,
    // tells.
    if (i == 0) {
      enough = tolerance * rz_new;
    } else if (rz_new <= enough && last_gain <= tolerance * gain) {
      break;
    } else {
      add(z, rz_new / rz, p);
    }
    p = std::move(z);
    rz = rz_new;
    // q = H p = K p + (K(u) - K(0)) p + d2Psi/du2 p, with K p = source of p.
    Eigen::VectorXd q = p.source_n;
    near_.add_change(p.displacement_m, q);
    contact_.add_curvature(p.displacement_m, q);
    near_.mask(q);
    const double curvature = p.displacement_m.dot(q);
    report.indefinite = !(curvature > 0.0);
    if (report.indefinite) {
      if (i == 0) {
        direction = p;
      }
      break;
    }
    const double alpha = rz / curvature;
    add(direction, alpha, p);
    r -= alpha * q;
    learnt.push_back({p, std::move(q), 1.0 / curvature});
    last_gain = alpha * rz;
    gain += last_gain;
  }
  slow_ = learnt.size() > kManyGradients;
  learn(std::move(learnt));
  return direction;
}

Equilibrium::Step Equilibrium::newton_step(const PlacedTool& tool,
                                           const Multipliers& multipliers,
                                           const NearState& state,
                                           EquilibriumReport& report) {
  // Gradient of W + Psi on the near nodes: s + d(excess)/du + dPsi/du, with K u = s.
  Eigen::VectorXd gradient = state.source_n;
  near_.linearise(state.displacement_m, gradient, convex_);
  if (tangent_ != nullptr && slow_) {
    tangent_->refresh();
  }
  contact_.linearise(state.displacement_m, tool, multipliers, gradient);
  near_.mask(gradient);
  report.imbalance_n =
      Eigen::Map<const Eigen::Matrix3Xd>(gradient.data(), 3, gradient.size() / 3)
          .rowwise()
          .sum()
          .norm();
  NearState direction = conjugate_gradients(-gradient, report);
  if (tangent_ != nullptr && tangent_->ready() && !pair_exactly(direction)) {
    forget_tangents();
    direction = conjugate_gradients(-gradient, report);
  }
  const double slope = gradient.dot(direction.displacement_m);
  return {std::move(direction), slope};
}

// One Newton step. False if the energy does not fall along it.
bool Equilibrium::descend(const PlacedTool& tool, const Multipliers& multipliers,
                          NearState& state, ElementBatches::Energy& elastic,
                          EquilibriumReport& report) {
  constexpr double kArmijo = 1e-4;
  constexpr double kShortest = 1e-6;
  constexpr double kNearRest = 1e-3;  // [-] decrement
  const Step step = newton_step(tool, multipliers, state, report);
  ++report.newton;
  const double scale =
      std::max(std::abs(elastic.energy_j), std::numeric_limits<double>::min());
  report.decrement_relative = -step.slope / scale;
  // Past 1e-14 the energy's own rounding decides.
  const double energy =
      elastic.energy_j + contact_energy_j(tool, multipliers, state) + 1e-14 * scale;
  const double thinnest = kThinner * elastic.smallest_jacobian;
  bool admissible = false;
  for (double length = 1.0; length > kShortest; length *= 0.5) {
    NearState next = state;
    add(next, length, step.direction);
    const ElementBatches::Energy there = this->elastic(next);
    if (!admissible) {
      if (there.smallest_jacobian < thinnest) {
        continue;
      }
      admissible = true;
      if (length < kCreeping && report.decrement_relative > kFarFromRest) {
        ++report.creeping;
      }
    }
    if (std::isfinite(there.energy_j) &&
        there.energy_j + contact_energy_j(tool, multipliers, next) <=
            energy + kArmijo * length * step.slope) {
      state = std::move(next);
      elastic = there;
      convex_ = length < 0.5 || (convex_ && report.decrement_relative > kNearRest);
      return true;
    }
  }
  // The true tangent may have led uphill: the other one is worth a step.
  convex_ = !convex_;
  return convex_;
}

EquilibriumReport Equilibrium::find(const PlacedTool& tool, NearState& state,
                                    Multipliers& multipliers,
                                    const EquilibriumLimits& limits) {
  EquilibriumReport report;
  ElementBatches::Energy energy = elastic(state);
  if (!std::isfinite(energy.energy_j)) {
    report.failure = "the start turns an element inside out";
    return report;
  }
  double enough = options_.update_relative;
  convex_ = false;
  while (report.newton < std::min(options_.newton_max, limits.newton_max) &&
         report.gradients < options_.gradients_total) {
    check_interrupted();
    if (!descend(tool, multipliers, state, energy, report) &&
        report.decrement_relative > 100.0 * options_.decrement_relative) {
      report.failure = "no step lowers the energy";
      return report;
    }
    if (limits.may_give_up && report.creeping >= kMostCreeping) {
      report.failure = "steps turn elements inside out";
      report.too_far = true;
      return report;
    }
    if (report.decrement_relative > enough) {
      continue;
    }
    report.contact = contact_.evaluate(state.displacement_m, tool, multipliers);
    const ContactState& contact = report.contact;
    const double sum = contact.pressure_n.sum();
    const double change =
        (contact.pressure_n - multipliers.pressure_n).cwiseAbs().sum() +
        (contact.tie_n - multipliers.tie_n).rowwise().norm().sum();
    report.multiplier_relative = sum > 0.0 ? change / sum : 0.0;
    report.give_m = spring_give_m(contact, multipliers);
    if (report.multiplier_relative > options_.multiplier_relative &&
        report.give_m > limits.give_m && report.lagrange < options_.lagrange_max) {
      multipliers.pressure_n = contact.pressure_n;
      multipliers.tie_n = contact.tie_n;
      ++report.lagrange;
    } else if (report.decrement_relative > options_.decrement_relative) {
      enough = options_.decrement_relative;
    } else if (report.imbalance_n >
                   options_.imbalance_relative * contact.force_n.norm() &&
               sum > 0.0) {
      forget_tangents();
    } else {
      // Rounded solves have left the far field out of balance by their rounding.
      state.displacement_m = solve_(near_.dof(), state.source_n, SolveWith::kFactor);
      report.contact = contact_.evaluate(state.displacement_m, tool, multipliers);
      multipliers.pressure_n = contact.pressure_n;
      multipliers.tie_n = contact.tie_n;
      report.converged = true;
      return report;
    }
  }
  report.failure =
      fmt::format("{} Newton steps of {} conjugate gradients were not enough",
                  report.newton, report.gradients);
  return report;
}

}  // namespace palpate
