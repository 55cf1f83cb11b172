#include "fitting/lateral/lateral_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include "fitting/curve/misfit.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"
#include "formats/base/named_message.h"

namespace palpate {
namespace {

constexpr double kByChance = 1e-3;
constexpr double kNormal95OneSided = 1.644854;
constexpr double kStiffVariance = 1.0;  // of ln k: more is no value
constexpr std::size_t kSticksPerMotion = 2;

using LogPair = Eigen::Vector2d;  // ln k, ln S

// A run as solved, with covariance of ln k and ln S, the instrument's error in it.
struct RunSolution {
  const LateralRun& run;
  const LateralPath& path;
  SolvedLoop solved;
  LogPair q;
  Eigen::Matrix2d covariance;

  [[nodiscard]] bool sticks() const {
    const LoopSamples& samples = solved.samples;
    return samples.sticks >=
               std::max(kLoopPartMin, kSticksPerMotion * samples.motions) &&
           covariance(0, 0) < kStiffVariance && !solved.endless &&
           !solved.held[static_cast<std::size_t>(kLogStiffness)];
  }
  [[nodiscard]] bool has_normal() const { return !std::isnan(path.normal_n); }
  [[nodiscard]] bool tells_friction() const { return has_normal() && solved.slides; }
  // S of mu = 1.
  [[nodiscard]] double log_normal() const { return std::log(path.normal_n); }
};

// Of common parameters: ln mu, its variance, and whether those of the runs differ.
struct CommonFriction {
  std::size_t runs = 0;
  double log_mu = 0.0, variance = 0.0;
  bool differ = false;
};

bool beyond_chance(double chi_squared, std::size_t count) {
  return count > 1 &&
         chi_squared >
             boost::math::quantile(boost::math::complement(
                 boost::math::chi_squared(static_cast<double>(count - 1)), kByChance));
}

RunSolution solve_run(const LateralRun& run, const LateralPath& path, ContactLaw law,
                      const FrameCompliance* frame) {
  const double instrument = frame == nullptr ? std::numeric_limits<double>::infinity()
                                             : frame->stiffness_n_per_m;
  RunSolution s{run, path, solve_loop(path, law, instrument), {}, {}};
  s.q = s.solved.q.head<2>();
  s.covariance = s.solved.covariance.topLeftCorner<2, 2>();
  // 1/k = 1/both - 1/k_i: dk/k = -(k/k_i) dk_i/k_i.
  if (frame != nullptr && frame->stiffness_sd_n_per_m > 0.0) {
    const double share =
        std::exp(s.q[0]) / instrument * frame->stiffness_sd_n_per_m / instrument;
    s.covariance(0, 0) += share * share;
  }
  return s;
}

CommonFriction common_friction(const std::vector<RunSolution>& solutions) {
  CommonFriction common;
  double weights = 0.0, sum = 0.0, squares = 0.0;
  for (const RunSolution& s : solutions) {
    if (!s.tells_friction() || !s.covariance.allFinite()) {
      continue;
    }
    const double weight =
        1.0 / std::max(s.covariance(1, 1), std::numeric_limits<double>::min());
    const double log_mu = s.q[1] - s.log_normal();
    // Deviations from the first: squares of small numbers.
    const double first = common.runs == 0 ? log_mu : common.log_mu;
    common.log_mu = first;
    weights += weight;
    sum += weight * (log_mu - first);
    squares += weight * (log_mu - first) * (log_mu - first);
    ++common.runs;
  }
  if (common.runs == 0) {
    return common;
  }
  const double chi_squared = squares - sum * sum / weights;
  common.log_mu += sum / weights;
  common.variance = 1.0 / weights;
  common.differ = beyond_chance(chi_squared, common.runs);
  if (common.differ) {
    common.variance *= chi_squared / static_cast<double>(common.runs - 1);
  }
  return common;
}

// Given ln mu with its variance, ln k follows by their correlation.
void take_common(const CommonFriction& common, RunSolution& s) {
  if (common.runs < 2 || common.differ || !s.tells_friction() ||
      !(s.covariance(1, 1) > 0.0)) {
    return;
  }
  const double slope = s.covariance(0, 1) / s.covariance(1, 1);
  const double log_slip = common.log_mu + s.log_normal();
  s.q[0] += slope * (log_slip - s.q[1]);
  s.q[1] = log_slip;
  s.covariance(0, 0) += slope * slope * (common.variance - s.covariance(1, 1));
  s.covariance(0, 1) = s.covariance(1, 0) = slope * common.variance;
  s.covariance(1, 1) = common.variance;
}

IntervalEstimate of_logs(const RunSolution& s, double by_k, double by_slip,
                         double log_factor = 0.0) {
  return estimate_of_log(
      [&](const Eigen::VectorXd& q) {
        return by_k * q[0] + by_slip * q[1] + log_factor;
      },
      s.q, s.covariance);
}

// Largest force that the contact bore, a lower bound of S [N]; at 95 %.
double borne_n(const RunSolution& s, const std::vector<FrictionState>& states) {
  double most = 0.0;
  for (const std::size_t i : s.path.fitted) {
    most = std::max(most, std::abs(states[i].share));
  }
  const double force = most * std::exp(s.solved.q[kLogSlip]);
  // Of a spring the error is that of its stiffness.
  const double sd = std::sqrt(std::max(0.0, s.covariance(0, 0)));
  return force * (1.0 - std::min(1.0, kNormal95OneSided * sd));
}

void state_friction(const RunSolution& s, const std::vector<FrictionState>& states,
                    RunFit& fit) {
  const std::string no_normal =
      "no normal force is given: --normal-force-column or --normal-force-n";
  if (s.solved.slides) {
    fit.slip_force_n = of_logs(s, 0.0, 1.0);
    fit.friction = s.has_normal() ? of_logs(s, 0.0, 1.0, -s.log_normal())
                                  : refused_estimate(no_normal);
    fit.presliding_m = s.sticks() ? of_logs(s, -1.0, 1.0)
                                  : refused_estimate("needs the tangential stiffness");
    return;
  }
  const std::string never = "the contact never slides";
  if (!s.sticks()) {  // noise bears nothing
    fit.slip_force_n = fit.presliding_m = refused_estimate(never);
    fit.friction = refused_estimate(s.has_normal() ? never : no_normal);
    return;
  }
  const double borne = borne_n(s, states);
  fit.slip_force_n = refused_estimate(never, borne);
  fit.friction = s.has_normal() ? refused_estimate(never, borne / s.path.normal_n)
                                : refused_estimate(no_normal);
  fit.presliding_m = refused_estimate(never, borne / std::exp(s.q[0]));
}

void state_loss(const RunSolution& s, RunFit& fit) {
  const LoopLosses losses = loop_losses(s.path, s.solved);
  fit.cycle = losses.cycle;
  if (losses.cycle.empty()) {
    fit.loss_j = fit.modelled_loss_j = refused_estimate("no closed loop");
    return;
  }
  double measured = 0.0, amplitude = 0.0;
  for (const LoopCycle& cycle : losses.cycle) {
    measured += cycle.measured_j / static_cast<double>(losses.cycle.size());
    amplitude += cycle.amplitude_m / static_cast<double>(losses.cycle.size());
  }
  double sd = losses.mean_sd_j;
  if (beyond_chance(losses.chi_squared, losses.cycle.size())) {
    sd *= std::sqrt(losses.chi_squared / static_cast<double>(losses.cycle.size() - 1));
    fit.notes.emplace_back(
        "the loops of the cycles differ beyond noise: the force depends on rate or "
        "time, or the surface changes");
  }
  fit.loss_j = {measured, sd, measured - kNormal95 * sd, measured + kNormal95 * sd};
  fit.modelled_loss_j = estimate(
      [&](const Eigen::VectorXd& q) {
        const ContactCurve curve{s.solved.law, std::exp(q[0]), std::exp(q[1]),
                                 s.solved.instrument_n_per_m};
        return loop_loss_j(curve, amplitude);
      },
      s.q, s.covariance);
}

void note_what_was_done(const RunSolution& s, RunFit& fit) {
  const auto held = [&](LoopParameter j) {
    return s.solved.held[static_cast<std::size_t>(j)];
  };
  if (s.path.apart > 0) {
    fit.notes.push_back(fmt::format(
        "{} samples at the ends have less than half of the normal force: left out",
        s.path.apart));
  }
  if (s.path.force_turned) {
    fit.notes.emplace_back("the force's sign is changed: it does work on the contact");
  }
  const LoopSamples& samples = s.solved.samples;
  if (held(kZero) && std::min(samples.slides_up, samples.slides_down) < kLoopPartMin) {
    fit.notes.emplace_back(
        "the contact does not slide both ways: the force where the motion begins is "
        "taken for 0");
  }
  if (held(kDrift)) {
    fit.notes.emplace_back("too little motion both ways to tell a drift: taken for 0");
  }
}

// Samples that stick and yet tell no stiffness: noise, or a frame that is too soft.
IntervalEstimate no_stiffness(const RunSolution& s) {
  const bool untold = s.solved.endless || !(s.covariance(0, 0) < kStiffVariance);
  if (s.solved.samples.sticks >= kLoopPartMin && untold) {
    return refused_estimate(
        std::isfinite(s.solved.instrument_n_per_m)
            ? "the frame as stated deflects as far as contact and frame together"
            : "the force does not follow the displacement");
  }
  return refused_estimate(
      "too few samples between rest and sliding: their steps are as long as the "
      "presliding length",
      s.solved.stiffest_n_per_m > 0.0 ? s.solved.stiffest_n_per_m
                                      : std::numeric_limits<double>::quiet_NaN());
}

RunFit run_fit_of(const RunSolution& s) {
  RunFit fit;
  fit.name = s.run.name;
  fit.depth_m = s.run.depth_m;
  fit.normal_n = s.path.normal_n;
  fit.samples = s.solved.samples;
  fit.offset_n = s.solved.q[kOffset] * s.solved.range_n;
  fit.zero_m = s.solved.zero_m(s.path, s.solved.q);
  fit.rms_n = s.solved.range_n * s.solved.residual.norm() /
              std::sqrt(static_cast<double>(s.solved.residual.size()));
  fit.stiffness_n_per_m = s.sticks() ? of_logs(s, 1.0, 0.0) : no_stiffness(s);
  fit.drift_n = s.solved.held[kDrift] ? refused_estimate("not separated from friction")
                                      : estimate(
                                            [&](const Eigen::VectorXd& q) {
                                              return q[kDrift] * s.solved.range_n;
                                            },
                                            s.solved.q, s.solved.covariance);
  state_friction(s, states_along(s.path, s.solved.curve(), fit.zero_m), fit);
  state_loss(s, fit);
  note_what_was_done(s, fit);
  return fit;
}

// Weighted mean of the runs' logarithms; a scene has one.
IntervalEstimate mean_presliding(const std::vector<RunFit>& loops) {
  double weights = 0.0, sum = 0.0, squares = 0.0, first = 0.0;
  std::size_t count = 0;
  for (const RunFit& loop : loops) {
    const IntervalEstimate& e = loop.presliding_m;
    if (e.refused.empty()) {
      const double relative = std::max(e.sd / e.value, 1e-12);
      const double weight = 1.0 / (relative * relative);
      first = count == 0 ? std::log(e.value) : first;
      const double log = std::log(e.value) - first;
      weights += weight;
      sum += weight * log;
      squares += weight * log * log;
      ++count;
    }
  }
  if (count == 0) {
    return loops.front().presliding_m;
  }
  const double freedom = std::max(1.0, static_cast<double>(count) - 1.0);
  const double spread = std::max(1.0, (squares - sum * sum / weights) / freedom);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, first + sum / weights);
  return estimate_of_log(
      [](const Eigen::VectorXd& at) {
        return at[0];
      },
      q, Eigen::MatrixXd::Constant(1, 1, spread / weights));
}

LawFit fit_of_law(std::vector<RunSolution>& solutions) {
  LawFit fit;
  fit.law = solutions.front().solved.law;
  const CommonFriction common = common_friction(solutions);
  fit.frictions_differ = common.differ;
  double squares = 0.0, samples = 0.0;
  for (RunSolution& s : solutions) {
    fit.runs.push_back(run_fit_of(s));
    const IntervalEstimate own = fit.runs.back().friction;
    take_common(common, s);
    if (common.runs > 1 && !common.differ) {
      fit.runs.back() = run_fit_of(s);
      fit.runs.back().friction = own;
    }
    const auto n = static_cast<double>(s.solved.residual.size());
    squares += n * fit.runs.back().rms_n * fit.runs.back().rms_n;
    samples += n;
  }
  fit.rms_n = std::sqrt(squares / samples);
  fit.presliding_m = mean_presliding(fit.runs);
  fit.friction = common.runs == 0
                     ? fit.runs.front().friction
                     : estimate_of_log(
                           [](const Eigen::VectorXd& q) {
                             return q[0];
                           },
                           Eigen::VectorXd::Constant(1, common.log_mu),
                           Eigen::MatrixXd::Constant(1, 1, common.variance));
  return fit;
}

std::span<const double> run_residuals(const RunSolution& s) {
  return {s.solved.residual.data(), static_cast<std::size_t>(s.solved.residual.size())};
}

// -2 log of how much less likely the second law is. @param by whose noise counts
double deviance_of(const std::vector<RunSolution>& by,
                   const std::vector<RunSolution>& other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < by.size(); ++i) {
    if (!(by[i].solved.residual.squaredNorm() > 0.0)) {
      const bool equal = !(other[i].solved.residual.squaredNorm() > 0.0);
      sum += equal ? 0.0 : std::numeric_limits<double>::max() / 1e10;
      continue;
    }
    std::vector<double> x;
    for (const std::size_t j : by[i].path.fitted) {
      x.push_back(by[i].path.displacement_m[j]);
    }
    std::vector<double> residual(run_residuals(other[i]).begin(),
                                 run_residuals(other[i]).end());
    for (double& r : residual) {
      r *= other[i].solved.range_n / by[i].solved.range_n;
    }
    sum += ResidualNoise(x, run_residuals(by[i])).deviance(residual);
  }
  return sum;
}

double log_squares(const std::vector<RunSolution>& solutions) {
  double sum = 0.0;
  for (const RunSolution& s : solutions) {
    sum += static_cast<double>(s.solved.residual.size()) *
           std::log(std::max(s.solved.residual.squaredNorm(),
                             std::numeric_limits<double>::min()));
  }
  return sum;
}

std::vector<LateralPath> paths_of(const std::vector<LateralRun>& runs) {
  std::vector<LateralPath> paths;
  for (const LateralRun& run : runs) {
    try {
      paths.push_back(find_lateral_path(run));
    } catch (const InputError& error) {
      throw InputError(with_name(run.name, error.what()));
    }
  }
  return paths;
}

}  // namespace

LateralFit fit_lateral(const std::vector<LateralRun>& runs,
                       const FrameCompliance* frame) {
  if (runs.empty()) {
    throw InputError("no measurement of a lateral motion");
  }
  if (frame != nullptr && !frame->linear) {
    throw InputError(
        "the frame's stiffness is not constant, which a lateral fit needs: state "
        "--frame-stiffness-n-per-m");
  }
  const std::vector<LateralPath> paths = paths_of(runs);
  std::vector<RunSolution> sharp, partial;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    sharp.push_back(solve_run(runs[i], paths[i], ContactLaw::kSharpSlip, frame));
    partial.push_back(solve_run(runs[i], paths[i], ContactLaw::kPartialSlip, frame));
  }
  const bool is_sharp = log_squares(sharp) <= log_squares(partial);
  std::vector<RunSolution>&better = is_sharp ? sharp : partial,
  &other = is_sharp ? partial : sharp;
  LateralFit fit;
  fit.deviance = deviance_of(better, other);
  fit.better = fit_of_law(better);
  fit.other = fit_of_law(other);
  return fit;
}

}  // namespace palpate
