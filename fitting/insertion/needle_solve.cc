#include "fitting/insertion/needle_solve.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "fitting/insertion/needle_start.h"
#include "fitting/numerics/correlated_noise.h"

namespace palpate {
namespace {

constexpr double kExponentMin = 1.0, kExponentMax = 2.5;
constexpr double kLeastCutting = 1e-4;  // [-] of the force at the first rupture
constexpr double kFreeClock = 0.02;     // [-] of a file, free before a drift is seen
constexpr double kStickingGain = 20.0;  // variances of slow noise
constexpr int kMoves = 4;               // of ruptures, each with a solve

struct LayerSamples {
  std::size_t cut = 0;     // while the tip cuts the layer
  std::size_t rise = 0;    // while the force rises to the next membrane
  std::size_t inside = 0;  // with the end of the inserted length in the layer
};

std::vector<LayerSamples> layer_samples_of(const FittedSamples& fitted,
                                           const NeedleModel& model,
                                           const Eigen::VectorXd& q) {
  const int ruptures = model.events().ruptures;
  std::vector<LayerSamples> counts(static_cast<std::size_t>(ruptures));
  const std::vector<NeedleTerm> ends = model.channels(q);
  for (const NeedleSample& s : fitted.sample) {
    const auto pass = static_cast<std::size_t>(s.pass);
    const bool inwards = s.shaft == ShaftState::kInwards;
    const NeedleTerm before = pass > 0 ? ends[pass - 1] : model.constant(0.0);
    const double opened =
        inwards ? model.channel(q, model.constant(s.depth_m), s.ruptures, before).value
                : ends[pass].value;
    const double l = std::min(opened, s.depth_m - q[NeedleModel::kContact]);
    int layer = 1;
    while (layer < ruptures && l > q[model.boundary(layer)]) {
      ++layer;
    }
    counts[static_cast<std::size_t>(layer - 1)].inside += l > 0.0 ? 1 : 0;
    if (inwards && s.ruptures > 0 && opened > before.value) {
      LayerSamples& now = counts[static_cast<std::size_t>(s.ruptures - 1)];
      const bool rises =
          s.ruptures < ruptures && opened >= q[model.boundary(s.ruptures)];
      ++(rises ? now.rise : now.cut);
    }
  }
  return counts;
}

bool sticks_in(const FittedSamples& fitted, int pass) {
  return std::any_of(fitted.sample.begin(), fitted.sample.end(),
                     [&](const NeedleSample& s) {
                       return s.pass == pass && s.shaft == ShaftState::kSticks;
                     });
}

// Whether a later pass cuts on where this one has turned.
bool goes_on_beyond(const FittedSamples& fitted, const NeedleModel& model, int pass) {
  const double turn_m = model.events().turn_m[static_cast<std::size_t>(pass)];
  return std::any_of(fitted.sample.begin(), fitted.sample.end(),
                     [&](const NeedleSample& s) {
                       return s.pass > pass && s.depth_m > turn_m;
                     });
}

// Parameters that no sample tells anything of stay where they are.
std::vector<bool> held_parameters(const SolvedNeedle& now) {
  const NeedleModel& model = now.model;
  std::vector<bool> held(static_cast<std::size_t>(model.parameters()), false);
  const auto hold = [&](int j) {
    held[static_cast<std::size_t>(j)] = true;
  };
  const auto counts = layer_samples_of(now.fitted, model, now.q);
  for (int layer = 1; layer <= model.events().ruptures; ++layer) {
    const LayerSamples& count = counts[static_cast<std::size_t>(layer - 1)];
    if (count.cut < kNeedlePartMin) {
      hold(model.cutting(layer));
    }
    if (count.inside < kNeedlePartMin) {
      hold(model.friction(layer));
    }
    if (layer < model.events().ruptures && count.rise < 2) {
      hold(model.boundary(layer));
    }
  }
  bool sticks = false;
  for (int pass = 0; pass < static_cast<int>(model.events().turn_m.size()); ++pass) {
    if (sticks_in(now.fitted, pass)) {
      sticks = true;
    } else if (!goes_on_beyond(now.fitted, model, pass)) {
      hold(model.turn(pass));
    }
  }
  if (!sticks) {
    hold(NeedleModel::kPresliding);
  }
  const auto baselines =
      baseline_samples(now.fitted, model.events().files, now.q[NeedleModel::kContact]);
  for (int file = 0; file < model.events().files; ++file) {
    if (!baselines[static_cast<std::size_t>(file)].drift) {
      hold(model.drift(file));
    }
  }
  return held;
}

LeastSquaresProblem needle_problem(const SolvedNeedle& now) {
  const NeedleModel& model = now.model;
  const Eigen::Index p = model.parameters();
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(now.fitted.sample.size());
  problem.evaluate = [&](const Eigen::VectorXd& q, const Eigen::Ref<Eigen::VectorXd>& r,
                         RowMajorMatrix* jacobian) {
    model.evaluate(now.fitted.sample, now.fitted.force_n, q, r, jacobian);
    return true;
  };
  problem.lower = Eigen::VectorXd::Constant(p, -kInf);
  problem.upper = Eigen::VectorXd::Constant(p, kInf);
  problem.lower[NeedleModel::kExponent] = kExponentMin;
  problem.upper[NeedleModel::kExponent] = kExponentMax;
  for (int layer = 1; layer <= model.events().ruptures; ++layer) {
    problem.lower[model.cutting(layer)] =
        kLeastCutting * std::exp(now.q[NeedleModel::kLogForce]);
  }
  problem.held = now.held;
  return problem;
}

void solve_at_events(const NeedlePath& path, SolvedNeedle& now) {
  now.fitted = fitted_samples(path, now.switches, now.q[NeedleModel::kContact]);
  now.held = held_parameters(now);
  const LeastSquaresProblem problem = needle_problem(now);
  const LeastSquaresReport report =
      solve_least_squares(problem, now.q, {.tolerance = 1e-10});
  now.q = report.q;
  now.converged = report.converged;
  now.residual.resize(problem.residuals);
  now.jacobian.resize(problem.residuals, now.q.size());
  static_cast<void>(problem.evaluate(now.q, now.residual, &now.jacobian));
  const auto free = std::count(now.held.begin(), now.held.end(), false);
  now.variance =
      now.residual.squaredNorm() /
      static_cast<double>(std::max<std::ptrdiff_t>(1, problem.residuals - free));
}

void solve_moving_ruptures(const NeedlePath& path, SolvedNeedle& now) {
  for (int i = 0; i < kMoves; ++i) {
    solve_at_events(path, now);
    if (!move_ruptures(path, now.model, now.q, now.variance, now.switches)) {
      return;
    }
  }
}

// Slow noise makes lines, too: what sticks follows better by many of its variances.
void find_sticking(const NeedlePath& path, SolvedNeedle& now) {
  const std::span<const double> residuals(
      now.residual.data(), static_cast<std::size_t>(now.residual.size()));
  const double slow = now.variance * static_cast<double>(residuals.size()) /
                      effective_samples(residuals);
  now.switches.stuck =
      find_stuck_samples(path, now.model, now.q, now.variance, kStickingGain * slow);
}

// k_b [N/m] of the straight line through what sticks, to start from.
double presliding_start(const NeedlePath& path, const SolvedNeedle& now) {
  const std::vector<NeedleTerm> ends = now.model.channels(now.q);
  for (std::size_t p = 0; p < path.pass.size(); ++p) {
    const StuckSamples& stuck = now.switches.stuck[p];
    if (stuck.count != StuckSamples::kUnknown && stuck.count >= kNeedlePartMin) {
      const NeedlePass& pass = path.pass[p];
      const std::size_t last = std::min(pass.out_begin + stuck.count, pass.out_end) - 1;
      const double way = pass.turn_m - path.depth_m[last];
      const double friction =
          now.model.shaft_friction(now.q, now.model.turn_depth(now.q, p), ends[p])
              .value;
      return way > 0.0 ? 2.0 * std::abs(friction) / way : 0.0;
    }
  }
  return 0.0;
}

// How far the friction lags after each rupture: what it rises over k_b; two samples
// where k_b is not known.
void find_lags(const NeedlePath& path, SolvedNeedle& now) {
  const std::vector<NeedleTerm> ends = now.model.channels(now.q);
  const double stiffness = now.q[NeedleModel::kPresliding];
  for (std::size_t k = 0; k < now.switches.ruptures.size(); ++k) {
    RuptureSamples& rupture = now.switches.ruptures[k];
    const NeedleTerm depth = now.model.constant(path.depth_m[rupture.before]);
    NeedleTerm before = now.model.constant(0.0);
    for (std::size_t p = 0; p < ends.size(); ++p) {
      before = path.pass[p].in_end <= rupture.before ? ends[p] : before;
    }
    const auto friction = [&](int ruptures) {
      return now.model
          .shaft_friction(now.q, depth,
                          now.model.channel(now.q, depth, ruptures, before))
          .value;
    };
    const int layer = static_cast<int>(k) + 1;
    const double rise = std::max(0.0, friction(layer) - friction(layer - 1));
    const double step =
        std::abs(path.depth_m[rupture.after] - path.depth_m[rupture.before]);
    rupture.lag_m = stiffness > 0.0 ? rise / stiffness : 1.5 * step;
  }
}

}  // namespace

std::vector<BaselineSamples> baseline_samples(const FittedSamples& fitted, int files,
                                              double contact_m) {
  std::vector<BaselineSamples> found(static_cast<std::size_t>(files));
  for (int file = 0; file < files; ++file) {
    std::size_t in = 0, out = 0;
    double first = kInf, last = -kInf;
    BaselineSamples& here = found[static_cast<std::size_t>(file)];
    for (const NeedleSample& s : fitted.sample) {
      if (s.file != file) {
        continue;
      }
      const bool free = s.depth_m < contact_m;
      here.free += free ? 1 : 0;
      in += !free && s.shaft == ShaftState::kInwards ? 1 : 0;
      out += !free && s.shaft == ShaftState::kOutwards ? 1 : 0;
      first = free ? std::min(first, s.clock) : first;
      last = free ? std::max(last, s.clock) : last;
    }
    const bool both_ways = in >= 2 * kNeedlePartMin && out >= 2 * kNeedlePartMin;
    here.drift =
        both_ways || (here.free >= 2 * kNeedlePartMin && last - first >= kFreeClock);
  }
  return found;
}

std::size_t friction_samples(const FittedSamples& fitted, const NeedleModel& model,
                             const Eigen::VectorXd& q) {
  const std::vector<NeedleTerm> ends = model.channels(q);
  return static_cast<std::size_t>(std::count_if(
      fitted.sample.begin(), fitted.sample.end(), [&](const NeedleSample& s) {
        const double l = s.depth_m - q[NeedleModel::kContact];
        const bool out = s.shaft == ShaftState::kOutwards;
        const auto pass = static_cast<std::size_t>(s.pass);
        const double channel =
            out ? ends[pass].value : (pass > 0 ? ends[pass - 1].value : 0.0);
        return s.shaft != ShaftState::kSticks && l > 0.0 && (out || l < channel);
      }));
}

SolvedNeedle solve_needle(const NeedlePath& path,
                          const std::vector<RuptureSamples>& ruptures) {
  NeedleSwitches switches;
  switches.ruptures = ruptures;
  switches.stuck.resize(path.pass.size());
  const NeedleCurve curve = start_curve(path, ruptures.front());
  const double reference = path.depth_m[ruptures.front().before] - curve.contact_m;
  NeedleModel model(needle_events(path, switches, reference));
  SolvedNeedle now{.switches = switches,
                   .model = model,
                   .fitted = {},
                   .q = start_parameters(path, switches, model, curve),
                   .held = {},
                   .residual = {},
                   .jacobian = {}};
  solve_moving_ruptures(path, now);
  find_sticking(path, now);
  now.q[NeedleModel::kPresliding] = presliding_start(path, now);
  find_lags(path, now);
  solve_moving_ruptures(path, now);
  // The samples that stick tell of the force at the turn, too: once more.
  find_sticking(path, now);
  solve_moving_ruptures(path, now);
  return now;
}

Eigen::MatrixXd needle_covariance(const SolvedNeedle& solved) {
  std::vector<int> free;
  for (int j = 0; j < solved.q.size(); ++j) {
    if (!solved.held[static_cast<std::size_t>(j)]) {
      free.push_back(j);
    }
  }
  const Eigen::MatrixXd J = solved.jacobian(Eigen::all, free);
  const Eigen::MatrixXd of_free =
      covariance_under_noise(J, solved.residual, J.rows(), SharedNoise::kRough);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(solved.q.size(), solved.q.size());
  covariance(free, free) = of_free;
  return covariance;
}

}  // namespace palpate
