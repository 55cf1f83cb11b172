#include "precompute/contact/nonlinear_indentation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

namespace palpate {
namespace {

// [-] The least volume of an element that is predicted, as a share of the least before.
constexpr double kPredictedThinner = 0.3;
// A press that fails goes on with these.
constexpr double kStiffer = 10.0;
constexpr int kStiffUpdates = 1;
constexpr double kPointShare = 1.0;
constexpr int kPatience = 2;
// Near fields that are too small.
constexpr int kWidened = 2;
constexpr double kWider = 0.3;

class Press {
 public:
  Press(const NonlinearBody& body, std::span<const std::int32_t> patch,
        const Eigen::MatrixXd& compliance, double touch_m,
        std::span<const PressStep> steps,
        const std::function<PlacedTool(double)>& place, const RestSolve& solve,
        const NonlinearOptions& options)
      : body_(body),
        patch_(patch),
        steps_(steps),
        place_(place),
        solve_(solve),
        options_(options),
        near_gradient_(options.near_gradient),
        near_tet_(strained()),
        near_(body.mesh, body.material, body.supports, near_tet_,
              contact_mesh_nodes(body.surface, patch)),
        contact_(body.surface, body.mesh, patch, near_),
        tangent_(tangent_of(body)),
        equilibrium_(std::in_place, near_, contact_, solve, options.equilibrium,
                     tangent_ ? &*tangent_ : nullptr),
        touch_m_(touch_m),
        at_m_(touch_m),
        before_m_(touch_m) {
    // Springs k_v = factor / C_vv: as stiff as the body under node v, times the factor
    // [N/m].
    multipliers_.spring_n_per_m =
        options.spring_factor * compliance.diagonal().cwiseInverse();
    multipliers_.pressure_n = Eigen::VectorXd::Zero(contact_.nodes());
    multipliers_.tie_n = Eigen::MatrixX3d::Zero(contact_.nodes(), 3);
    multipliers_.anchor_m = Eigen::MatrixX3d::Zero(contact_.nodes(), 3);
    if (options.sticking) {
      multipliers_.tied.assign(patch.size(), 0);
    }
    if (options.stiff) {
      stiffen();
    }
  }

  NonlinearIndentation follow() {
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (!steps_[i].only_if_hard && !go_to(i)) {
        break;
      }
    }
    result_.near_singular = stiff_ || was_cut_ || was_indefinite_;
    if (!result_.sample.empty()) {
      result_.far_excess_relative = far_excess_relative(near_tet_, displacement_m(),
                                                        result_.sample.back().energy_j);
    }
    result_.near_gradient = near_gradient_;
    result_.near_tets = near_.tets();
    result_.near_nodes = near_.size() / 3;
    result_.near_tet = near_tet_;
    result_.near_dof = near_.dof();
    return std::move(result_);
  }

 private:
  // Takes a step. One that passes over others must be easy: if not, the contact turns
  // stiff and it is tried again; if that does not do, those it would pass over are
  // taken first.
  bool go_to(std::size_t i) {
    const PressStep& step = steps_[i];
    if (reached_ == 0) {
      start(step);
    }
    passes_over_ = next_ < i;
    NonlinearSample sample{.step = i, .penetration_m = step.penetration_m};
    if (reach(step.penetration_m, sample, 0)) {
      result_.sample.push_back(sample);
      result_.pressure_n = multipliers_.pressure_n;
      result_.state = state_;
      next_ = i + 1;
      return true;
    }
    if (next_ < i) {
      was_cut_ = true;
      if (!last_.converged && !last_.too_far && !stiff_) {
        stiffen();
        return go_to(i);
      }
      for (std::size_t k = next_; k <= i; ++k) {
        if (!go_to(k)) {
          return false;
        }
      }
      return true;
    }
    result_.failure =
        fmt::format("at {:.4g} mm: {}", 1e3 * step.penetration_m, last_.failure);
    return false;
  }

  std::optional<TangentFactor> tangent_of(const NonlinearBody& body) const {
    if (body.factor == nullptr || body.stiffness == nullptr) {
      return std::nullopt;
    }
    return TangentFactor(*body.factor, *body.stiffness, near_);
  }

  // As many tets as it takes for what the others miss to be small, in the linear
  // solution.
  std::vector<Eigen::Index> strained() {
    const Eigen::VectorXd load_n =
        pressure_load_n(body_.surface, patch_, steps_.back().linear_pressure_n);
    const Eigen::VectorXd u =
        solve_(body_.supports.free_index, load_n, SolveWith::kFactor);
    for (int attempt = 0;; ++attempt) {
      auto near_tet = strained_tets(body_.mesh, body_.material, u, near_gradient_);
      const double left_out = far_excess_relative(near_tet, u, 0.5 * load_n.dot(u));
      if (attempt == kWidened || left_out <= options_.far_excess_max) {
        return near_tet;
      }
      near_gradient_ *= kWider;
    }
  }

  [[nodiscard]] double far_excess_relative(std::span<const Eigen::Index> near_tet,
                                           const Eigen::VectorXd& u_m,
                                           double energy_j) const {
    return std::min(1.0, far_excess_j(body_.mesh, body_.material, near_tet, u_m) /
                             std::max(energy_j, std::numeric_limits<double>::min()));
  }

  // Of the whole body (3 n_nodes), at the last state.
  Eigen::VectorXd displacement_m() const {
    Eigen::VectorXd source = Eigen::VectorXd::Zero(3 * body_.mesh.position_m.rows());
    for (Eigen::Index n = 0; n < body_.mesh.position_m.rows(); ++n) {
      const std::int32_t near = near_.near_node(static_cast<std::int32_t>(n));
      if (near >= 0) {
        source.segment<3>(3 * n) = state_.source_n.segment<3>(3 * Eigen::Index{near});
      }
    }
    return solve_(body_.supports.free_index, source, SolveWith::kFactor);
  }

  // The linear body's state at a step, drawn back where it turns an element inside out.
  void start(const PressStep& step) {
    Eigen::VectorXd source = Eigen::VectorXd::Zero(near_.size());
    for (std::size_t i = 0; i < patch_.size(); ++i) {
      for (const NodalForce& entry : node_of(body_.surface, patch_[i]).load) {
        source.segment<3>(3 * Eigen::Index{near_.near_node(entry.node)}) +=
            step.linear_pressure_n[static_cast<Eigen::Index>(i)] * entry.force;
      }
    }
    near_.mask(source);
    state_.displacement_m = solve_(near_.dof(), source, SolveWith::kFactor);
    state_.source_n = std::move(source);
    multipliers_.pressure_n = step.linear_pressure_n;
    if (!state_.displacement_m.allFinite()) {  // no start at all: from rest
      state_.displacement_m.setZero();
      state_.source_n.setZero();
    }
    double scale = 1.0;
    while (!std::isfinite(near_.excess(scale * state_.displacement_m).energy_j)) {
      scale *= 0.5;
    }
    state_.displacement_m *= scale;
    state_.source_n *= scale;
    before_ = {Eigen::VectorXd::Zero(near_.size()),
               Eigen::VectorXd::Zero(near_.size())};
    pressure_before_ = Eigen::VectorXd::Zero(multipliers_.pressure_n.size());
  }

  // Secant prediction from the two states before.
  NearState predicted(double penetration_m, Multipliers& multipliers) const {
    if (reached_ == 0) {
      return state_;
    }
    const double t = (penetration_m - at_m_) / (at_m_ - before_m_);
    multipliers.pressure_n =
        (multipliers_.pressure_n + t * (multipliers_.pressure_n - pressure_before_))
            .cwiseMax(0.0);
    NearState state{
        state_.source_n + t * (state_.source_n - before_.source_n),
        state_.displacement_m + t * (state_.displacement_m - before_.displacement_m)};
    const double thinnest =
        kPredictedThinner * near_.excess(state_.displacement_m).smallest_jacobian;
    const ElementBatches::Energy there = near_.excess(state.displacement_m);
    return std::isfinite(there.energy_j) && there.smallest_jacobian > thinnest ? state
                                                                               : state_;
  }

  // Ties every node that bears pressure and is not tied yet to where it is now.
  void tie(const PlacedTool& tool, const Eigen::VectorXd& pressure_n,
           const Eigen::VectorXd& u, Multipliers& multipliers) const {
    if (!options_.sticking) {
      return;
    }
    const Eigen::MatrixX3d at = contact_.average_position_m(u);
    for (Eigen::Index v = 0; v < pressure_n.size(); ++v) {
      char& tied = multipliers.tied[static_cast<std::size_t>(v)];
      if (pressure_n[v] <= 0.0) {
        tied = 0;
        multipliers.tie_n.row(v).setZero();
      } else if (tied == 0) {
        tied = 1;
        multipliers.anchor_m.row(v) = at.row(v) - tool.reference_m.transpose();
      }
    }
  }

  [[nodiscard]] int newton_limit() const {
    return options_.equilibrium.newton_max +
           options_.newton_per_depth * static_cast<int>(steps_.size());
  }

  // Where the body may yield to a side, as a sharp edge does, updates of the
  // multipliers chase one another. Stiff springs and few updates make the potential's
  // minimum itself the answer.
  void stiffen() {
    stiff_ = true;
    multipliers_.spring_n_per_m *= kStiffer;
    multipliers_.point_share = kPointShare;
    EquilibriumOptions patient = options_.equilibrium;
    patient.lagrange_max = kStiffUpdates;
    patient.newton_max *= kPatience;
    patient.gradients_total *= kPatience;
    equilibrium_.emplace(near_, contact_, solve_, patient,
                         tangent_ ? &*tangent_ : nullptr);
  }

  // What holds at the state that was reached.
  void describe(const ContactState& contact, NonlinearSample& sample) const {
    sample.force_n = contact.force_n;
    sample.moment_nm = contact.moment_nm;
    sample.multiplier_relative = last_.multiplier_relative;
    sample.energy_j = equilibrium_->elastic_energy_j(state_);
    sample.largest_overlap_m = std::max(0.0, -contact.gap_m.minCoeff());
    sample.give_m = last_.give_m;
    sample.smallest_jacobian = near_.excess(state_.displacement_m).smallest_jacobian;
    sample.contact_area_m2 = 0.0;
    for (std::size_t i = 0; i < patch_.size(); ++i) {
      if (contact.pressure_n[static_cast<Eigen::Index>(i)] > 0.0) {
        sample.contact_area_m2 += node_of(body_.surface, patch_[i]).area_m2;
      }
    }
  }

  bool reach(double penetration_m, NonlinearSample& sample, int depth) {
    const PlacedTool tool = place_(penetration_m);
    Multipliers multipliers = multipliers_;
    NearState state = predicted(penetration_m, multipliers);
    const bool may_cut = depth < options_.bisections_max && newton_ <= newton_limit();
    last_ = equilibrium_->find(
        tool, state, multipliers,
        {.give_m = options_.give_relative * (penetration_m - touch_m_),
         .may_give_up = may_cut || was_cut_,
         .newton_max =
             passes_over_ ? options_.newton_easy : std::numeric_limits<int>::max()});
    sample.newton += last_.newton;
    sample.gradients += last_.gradients;
    sample.lagrange += last_.lagrange;
    newton_ += last_.newton;
    result_.newton += last_.newton;
    result_.gradients += last_.gradients;
    if (passes_over_ && (!last_.converged || (last_.indefinite && may_cut))) {
      return false;
    }
    if (!last_.converged && !stiff_ && !last_.too_far) {
      stiffen();
      return reach(penetration_m, sample, depth);
    }
    // Where the tangent is indefinite another branch begins: small steps find the one
    // that the body takes.
    if (!last_.converged || (last_.indefinite && may_cut)) {
      if (!may_cut) {
        return false;
      }
      was_cut_ = true;
      return reach(0.5 * (at_m_ + penetration_m), sample, depth + 1) &&
             reach(penetration_m, sample, depth + 1);
    }
    was_indefinite_ = was_indefinite_ || last_.indefinite;
    const ContactState& contact = last_.contact;
    tie(tool, contact.pressure_n, state.displacement_m, multipliers);
    before_ = std::move(state_);
    before_m_ = at_m_;
    pressure_before_ = multipliers_.pressure_n;
    if (reached_ == 0) {
      before_.source_n.setZero();
      before_.displacement_m.setZero();
      pressure_before_.setZero();
    }
    state_ = std::move(state);
    multipliers_ = std::move(multipliers);
    at_m_ = penetration_m;
    ++reached_;
    describe(contact, sample);
    return true;
  }

  const NonlinearBody& body_;
  std::span<const std::int32_t> patch_;
  std::span<const PressStep> steps_;
  const std::function<PlacedTool(double)>& place_;
  const RestSolve& solve_;
  NonlinearOptions options_;
  double near_gradient_;
  std::vector<Eigen::Index> near_tet_;
  NearField near_;
  ContactPotential contact_;
  std::optional<TangentFactor> tangent_;
  std::optional<Equilibrium> equilibrium_;
  Multipliers multipliers_;
  NearState state_;
  NearState before_;
  Eigen::VectorXd pressure_before_;
  double touch_m_;
  double at_m_;  // penetration of state_, and of the one before
  double before_m_;
  int reached_ = 0;
  int newton_ = 0;
  std::size_t next_ = 0;      // step after the last that was taken
  bool passes_over_ = false;  // the step that is being taken
  bool stiff_ = false;
  bool was_cut_ = false;  // some step was: a path that is hard to follow
  bool was_indefinite_ = false;
  EquilibriumReport last_;
  NonlinearIndentation result_;
};

}  // namespace

NonlinearIndentation indent_nonlinear(const NonlinearBody& body,
                                      std::span<const std::int32_t> patch,
                                      const Eigen::MatrixXd& compliance, double touch_m,
                                      std::span<const PressStep> steps,
                                      const std::function<PlacedTool(double)>& place,
                                      const RestSolve& solve,
                                      const NonlinearOptions& options) {
  return Press(body, patch, compliance, touch_m, steps, place, solve, options).follow();
}

}  // namespace palpate
