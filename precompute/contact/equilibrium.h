// Where a nonlinear body comes to rest against a rigid tool that does not move.
//
// Newton's method minimises the total potential W(u) + Psi(u). Each step solves the
// true tangent by truncated conjugate gradients (Steihaug 1983). The preconditioner is
// the body's rest factor, with what the steps before have learnt of tangents (Morales
// and Nocedal 2000). A line search on the energy itself (Armijo) then keeps elements
// from turning inside out. Multipliers of the contact are updated until the multipliers
// carry the whole pressure.
#pragma once

#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "precompute/contact/contact_potential.h"
#include "precompute/contact/near_field.h"
#include "precompute/contact/tangent_factor.h"
#include "precompute/fem/batched_solves.h"

namespace palpate {

struct EquilibriumOptions {
  /// [-] Newton ends when the energy that a full step promises is below this share of
  /// the elastic energy.
  double decrement_relative = 1e-7;
  /// [-] Multipliers are updated as soon as it is below this.
  double update_relative = 1e-2;
  /// [-] Multipliers end when they differ from the pressures by this share of the sum.
  double multiplier_relative = 0.03;
  /// [-] Newton goes on while the sum of the unbalanced forces is above this share of
  /// the contact's forces. Promised energy is only as good as the gradients behind it.
  double imbalance_relative = 0.02;
  /// Updates of the multipliers; what they lack after these, the springs carry.
  int lagrange_max = std::numeric_limits<int>::max();
  double gradient_tolerance = 0.4;  ///< [-] of each conjugate-gradient solve
  int newton_max = 35;              ///< steps in all; a usual depth takes 10
  int gradients_max = 120;          ///< conjugate gradients per step
  int gradients_total = 1500;       ///< in all; a usual depth takes 50
};

/// What is enough for one rest state.
struct EquilibriumLimits {
  /// [m] Multipliers end, too, where springs give way no more than this.
  double give_m = 0.0;
  /// A start that is too far away is not followed to the end.
  bool may_give_up = false;
  int newton_max = std::numeric_limits<int>::max();  ///< beside the options'
};

struct EquilibriumReport {
  bool converged = false;
  std::string failure;  ///< why not, as the end of a sentence
  /// Not converged because steps far from rest would turn elements inside out: from a
  /// nearer start, a tool that moves less, it may be.
  bool too_far = false;
  bool indefinite = false;  ///< the last step's tangent had negative curvature
  int newton = 0;
  int creeping = 0;  ///< Newton steps far from rest that would turn elements inside out
  int gradients = 0;  ///< conjugate-gradient iterations, one solve each
  int lagrange = 0;
  double decrement_relative = 0.0;
  double multiplier_relative = 0.0;
  double give_m = 0.0;       ///< spring_give_m at the rest state
  double imbalance_n = 0.0;  ///< [N] resultant out of balance where the last step began
  ContactState contact;      ///< at the rest state, where converged
};

class Equilibrium {
 public:
  /// All must outlive it.
  /// @param tangent takes the place of `solve` where that needs many gradients; or
  /// null.
  Equilibrium(NearField& near, ContactPotential& contact, const RestSolve& solve,
              const EquilibriumOptions& options, TangentFactor* tangent = nullptr)
      : near_(near),
        contact_(contact),
        solve_(solve),
        options_(options),
        tangent_(tangent) {}

  /// Finds the rest state from `state` and `multipliers`, and leaves it there.
  EquilibriumReport find(const PlacedTool& tool, NearState& state,
                         Multipliers& multipliers, const EquilibriumLimits& limits);

  [[nodiscard]] double elastic_energy_j(const NearState& state) const {
    return elastic(state).energy_j;
  }

 private:
  struct Step {
    NearState direction;
    double slope = 0.0;  // of the energy along it, < 0
  };
  // What a tangent A does along a direction p: A p, and 1 / (p . A p).
  struct KnownDirection {
    NearState along;
    Eigen::VectorXd change_n;
    double inverse_curvature = 0.0;
  };
  [[nodiscard]] bool pair_exactly(NearState& direction) const;
  [[nodiscard]] NearState preconditioned(const Eigen::VectorXd& r) const;
  void forget_tangents();
  void learn(std::vector<KnownDirection> directions);
  // Towards A^-1 r, A the tangent of the last linearisations.
  NearState conjugate_gradients(Eigen::VectorXd r, EquilibriumReport& report);
  // @param elastic of the state, before and after.
  bool descend(const PlacedTool& tool, const Multipliers& multipliers, NearState& state,
               ElementBatches::Energy& elastic, EquilibriumReport& report);
  Step newton_step(const PlacedTool& tool, const Multipliers& multipliers,
                   const NearState& state, EquilibriumReport& report);
  // Of the whole body; infinite where an element is turned inside out.
  [[nodiscard]] ElementBatches::Energy elastic(const NearState& state) const;
  [[nodiscard]] double contact_energy_j(const PlacedTool& tool,
                                        const Multipliers& multipliers,
                                        const NearState& state) const {
    return contact_.evaluate(state.displacement_m, tool, multipliers).energy_j;
  }

  NearField& near_;
  ContactPotential& contact_;
  const RestSolve& solve_;
  EquilibriumOptions options_;
  TangentFactor* tangent_;
  bool slow_ = false;                 // the last step needed many gradients
  std::deque<KnownDirection> known_;  // oldest first
  bool convex_ = false;  // the next step's tangent is to be without negative curvature
};

}  // namespace palpate
