#include "fitting/insertion/needle_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "fitting/insertion/force_falls.h"
#include "fitting/insertion/needle_solve.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kFrictionDeviations = 5.0;  // less friction tells no static ratio
constexpr double kMissDeviations = 5.0;
constexpr std::size_t kFreeResiduals = 20;  // samples

using Parameters = Eigen::VectorXd;

// The solution and what follows from it.
struct Solution {
  const NeedlePath& path;
  const SolvedNeedle& solved;
  Eigen::MatrixXd covariance;

  [[nodiscard]] const NeedleModel& model() const { return solved.model; }
  [[nodiscard]] bool held(int parameter) const {
    return solved.held[static_cast<std::size_t>(parameter)];
  }
  [[nodiscard]] IntervalEstimate parameter(int j) const {
    return estimate(
        [j](const Parameters& q) {
          return q[j];
        },
        solved.q, covariance);
  }
  // Pass of a rupture, and the middle and half of the gap in which it lies.
  [[nodiscard]] int pass_of(std::size_t k) const {
    int pass = 0;
    while (solved.switches.ruptures[k].before >=
           path.pass[static_cast<std::size_t>(pass)].in_end) {
      ++pass;
    }
    return pass;
  }
  [[nodiscard]] std::pair<double, double> gap_m(std::size_t k) const {
    const RuptureSamples& r = solved.switches.ruptures[k];
    const double low = path.depth_m[r.earliest];
    const double high = path.depth_m[r.latest - (r.after - r.before) + 1];
    return {0.5 * (low + high), 0.5 * std::abs(high - low)};
  }
  // Channel before rupture k, or after it.
  [[nodiscard]] NeedleTerm channel(const Parameters& q, std::size_t k,
                                   bool after) const {
    const auto pass = static_cast<std::size_t>(pass_of(k));
    const auto ends = model().channels(q);
    return model().channel(q, model().constant(gap_m(k).first),
                           static_cast<int>(after ? k + 1 : k),
                           pass > 0 ? ends[pass - 1] : model().constant(0.0));
  }
  [[nodiscard]] double tip(const Parameters& q, std::size_t k, bool after) const {
    return model().tip_force(q, gap_m(k).first, channel(q, k, after)).value;
  }
  [[nodiscard]] double shaft(const Parameters& q, std::size_t k, bool after) const {
    return model()
        .shaft_friction(q, model().constant(gap_m(k).first), channel(q, k, after))
        .value;
  }
};

IntervalEstimate rupture_fall(const Solution& s, std::size_t k) {
  return estimate(
      [&](const Parameters& q) {
        return s.tip(q, k, false) + s.shaft(q, k, false) - s.tip(q, k, true) -
               s.shaft(q, k, true);
      },
      s.solved.q, s.covariance);
}

FittedRupture rupture_of(const Solution& s, std::size_t k) {
  FittedRupture rupture;
  const auto [middle, half] = s.gap_m(k);
  rupture.pass = s.pass_of(k);
  rupture.measured_m = middle;
  rupture.depth_m = estimate(
      [&, at = middle](const Parameters& q) {
        return at - q[NeedleModel::kContact];
      },
      s.solved.q, s.covariance, half);
  const int boundary = s.model().boundary(static_cast<int>(k));
  if (k == 0) {
    rupture.boundary_m = {0.0, 0.0, 0.0, 0.0, {}};
  } else if (s.held(boundary)) {
    rupture.boundary_m = refused_estimate("the force does not rise before the rupture");
  } else {
    rupture.boundary_m = s.parameter(boundary);
  }
  const NeedleTerm opened = s.channel(s.solved.q, k, false);
  const double e = middle - s.solved.q[NeedleModel::kContact] - opened.value;
  // df/dz before the rupture; none while the tip cuts.
  const bool cuts = k > 0 && s.held(boundary);
  const double stiffness =
      cuts ? 0.0 : s.solved.q[NeedleModel::kExponent] * s.tip(s.solved.q, k, false) / e;
  rupture.force_n = estimate(
      [&](const Parameters& q) {
        return s.tip(q, k, false);
      },
      s.solved.q, s.covariance, stiffness * half);
  const IntervalEstimate fall = rupture_fall(s, k);
  rupture.fall_n = fall.value;
  rupture.deviations = fall.value / fall.sd;
  return rupture;
}

FittedLayer layer_of(const Solution& s, std::size_t k, bool separated) {
  const int layer = static_cast<int>(k) + 1;
  const int cutting = s.model().cutting(layer), friction = s.model().friction(layer);
  FittedLayer fitted;
  const auto short_layer = [](const char* what) {
    return refused_estimate(fmt::format("too few samples {}", what));
  };
  fitted.slope_n_per_m =
      s.held(friction) ? short_layer("in the layer") : s.parameter(friction);
  fitted.start_n = s.held(cutting) ? short_layer("while the layer is cut")
                                   : estimate(
                                         [&](const Parameters& q) {
                                           return q[cutting] + s.shaft(q, k, true);
                                         },
                                         s.solved.q, s.covariance);
  if (separated) {
    fitted.friction_n_per_m = fitted.slope_n_per_m;
    fitted.cutting_n = s.held(cutting) ? fitted.start_n : s.parameter(cutting);
    return fitted;
  }
  fitted.cutting_n = fitted.friction_n_per_m = refused_estimate(
      "not separated: no extraction and no second pass along the channel");
  return fitted;
}

// rho of one extraction: (k_b u - Phi(turn)) / Phi(l) where the shaft begins to slide.
IntervalEstimate static_ratio_of(const Solution& s, std::size_t p) {
  const StuckSamples& stuck = s.solved.switches.stuck[p];
  const NeedlePass& pass = s.path.pass[p];
  if (stuck.count == StuckSamples::kUnknown) {
    return refused_estimate("not separated: no reversal with an extraction");
  }
  std::vector<double> way{0.0};  // sample 1 is the first of the extraction
  for (std::size_t i = pass.out_begin; i < pass.out_end; ++i) {
    if (s.path.motion[i] == NeedleMotion::kOut) {
      way.push_back(pass.turn_m - s.path.depth_m[i]);
    }
  }
  if (stuck.count < kNeedlePartMin) {
    return refused_estimate(
        fmt::format("not separated: the shaft slides within {} samples of the reversal",
                    kNeedlePartMin));
  }
  if (stuck.most + 1 >= way.size()) {
    return refused_estimate("not separated: the shaft sticks to the end");
  }
  const double low = way[stuck.least], high = way[stuck.most + 1];
  const double slides = 0.5 * (low + high), half = 0.5 * (high - low);
  const int turn = s.model().turn(static_cast<int>(p));
  const auto friction = [&](const Parameters& q, double depth) {
    return s.model()
        .shaft_friction(q, s.model().constant(depth), s.model().channels(q)[p])
        .value;
  };
  const auto kinetic = [&](const Parameters& q) {
    return friction(q, pass.turn_m + q[turn]);
  };
  const IntervalEstimate at_turn = estimate(kinetic, s.solved.q, s.covariance);
  if (!(at_turn.value > kFrictionDeviations * at_turn.sd)) {
    return refused_estimate("not separated: the friction is within its error");
  }
  const double stiffness = s.solved.q[NeedleModel::kPresliding];
  const IntervalEstimate ratio = estimate(
      [&](const Parameters& q) {
        return (q[NeedleModel::kPresliding] * (slides + q[turn]) - kinetic(q)) /
               friction(q, pass.turn_m - slides);
      },
      s.solved.q, s.covariance,
      half * stiffness / friction(s.solved.q, pass.turn_m - slides));
  return ratio.value + kNormal95 * ratio.sd < 1.0
             ? refused_estimate(
                   "not separated: no peak of the force after the reversal")
             : ratio;
}

// Of the extraction that tells it best.
IntervalEstimate static_ratio(const Solution& s) {
  IntervalEstimate best = static_ratio_of(s, 0);
  for (std::size_t p = 1; p < s.path.pass.size(); ++p) {
    IntervalEstimate other = static_ratio_of(s, p);
    if (other.refused.empty() && (!best.refused.empty() || other.sd < best.sd)) {
      best = other;
    }
  }
  return best;
}

// Values less their own straight line.
std::vector<double> without_line(const std::vector<double>& values) {
  const auto n = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd line(n, 2);
  line << Eigen::VectorXd::Ones(n), Eigen::VectorXd::LinSpaced(n, -1.0, 1.0);
  const Eigen::Map<const Eigen::VectorXd> all(values.data(), n);
  const Eigen::Matrix2d normal = line.transpose() * line;
  const Eigen::VectorXd left = all - line * normal.inverse() * line.transpose() * all;
  return {left.data(), left.data() + n};
}

// Whether residuals in the tissue are beyond the noise of the first free travel.
void compare_residuals(const Solution& s, NeedleFit& fit) {
  std::vector<double> free, inside;
  for (std::size_t i = 0; i < s.solved.fitted.sample.size(); ++i) {
    const NeedleSample& sample = s.solved.fitted.sample[i];
    const double residual = s.solved.residual[static_cast<Eigen::Index>(i)];
    if (sample.depth_m >= s.solved.q[NeedleModel::kContact]) {
      inside.push_back(residual);
    } else if (sample.pass == 0 && sample.shaft == ShaftState::kInwards) {
      free.push_back(residual);
    }
  }
  fit.free_rms_n = std::numeric_limits<double>::quiet_NaN();
  if (free.size() < kFreeResiduals || inside.empty()) {
    return;
  }
  free = without_line(free);  // a bad fit may shift the baseline
  fit.free_rms_n = rms(free);
  // The noise is as autocorrelated in the tissue as before it; a misfit is more so.
  const double independent = effective_samples(free) / static_cast<double>(free.size());
  const double spread =
      std::sqrt(0.5 / (independent * static_cast<double>(free.size())) +
                0.5 / (independent * static_cast<double>(inside.size())));
  fit.misses = std::log(rms(inside) / fit.free_rms_n) > kMissDeviations * spread;
}

void note_what_is_missing(const Solution& s, bool separated, NeedleFit& fit) {
  if (!separated) {
    fit.notes.emplace_back(
        "cutting force and friction: one insertion tells their sum at the start of "
        "each "
        "layer, and the slope of the force");
  }
  const auto baselines = baseline_samples(s.solved.fitted, s.path.files,
                                          s.solved.q[NeedleModel::kContact]);
  for (int file = 0; file < s.path.files; ++file) {
    const BaselineSamples& here = baselines[static_cast<std::size_t>(file)];
    const std::string in =
        s.path.files > 1 ? fmt::format(" of file {}", file + 1) : std::string();
    if (!here.drift) {
      fit.notes.push_back(
          fmt::format("drift{}: too little free travel to tell it from friction; it is "
                      "taken for 0",
                      in));
    }
    if (here.free < kNeedlePartMin) {
      fit.notes.push_back(
          fmt::format("baseline{}: {} samples before contact; contact point and offset "
                      "are determined by "
                      "the shape of the curve alone",
                      in, here.free));
    }
  }
}

NeedleFit fit_of(const Solution& s) {
  NeedleFit fit;
  const double reference = s.model().events().reference_m;
  fit.coefficient = estimate_of_log(
      [&](const Parameters& q) {
        return q[NeedleModel::kLogForce] -
               q[NeedleModel::kExponent] * std::log(reference);
      },
      s.solved.q, s.covariance);
  fit.exponent = s.parameter(NeedleModel::kExponent);
  fit.contact_m = s.parameter(NeedleModel::kContact);
  const bool separated =
      friction_samples(s.solved.fitted, s.model(), s.solved.q) >= 2 * kNeedlePartMin;
  for (std::size_t k = 0; k < s.solved.switches.ruptures.size(); ++k) {
    fit.ruptures.push_back(rupture_of(s, k));
    fit.layers.push_back(layer_of(s, k, separated));
  }
  fit.static_ratio = static_ratio(s);
  fit.presliding_n_per_m = fit.static_ratio.refused.empty()
                               ? s.parameter(NeedleModel::kPresliding)
                               : refused_estimate(fit.static_ratio.refused);
  for (int file = 0; file < s.path.files; ++file) {
    const int drift = s.model().drift(file);
    fit.baselines.push_back({s.solved.q[s.model().offset(file)],
                             s.held(drift)
                                 ? refused_estimate("not separated from friction")
                                 : s.parameter(drift)});
  }
  fit.rms_n = s.solved.residual.norm() /
              std::sqrt(static_cast<double>(s.solved.residual.size()));
  fit.converged = s.solved.converged;
  fit.samples = s.solved.fitted.sample.size();
  compare_residuals(s, fit);
  note_what_is_missing(s, separated, fit);
  return fit;
}

// The rupture whose fall is farthest within its error; all are beyond: the number of
// ruptures.
std::size_t least_sure_rupture(const Solution& s) {
  const double limit = normal_quantile_above(
      kFalseFallRate / static_cast<double>(s.solved.fitted.sample.size()));
  const std::size_t count = s.solved.switches.ruptures.size();
  std::size_t worst = count;
  double least = limit;
  for (std::size_t k = 0; s.covariance.allFinite() && k < count; ++k) {
    const IntervalEstimate fall = rupture_fall(s, k);
    const double deviations = fall.sd > 0.0 ? fall.value / fall.sd : 0.0;
    if (deviations < least) {
      least = deviations;
      worst = k;
    }
  }
  return worst;
}

}  // namespace

NeedleFit fit_needle(const NeedlePath& path) {
  std::vector<RuptureSamples> ruptures = find_ruptures(path);
  std::size_t dropped = 0;
  while (!ruptures.empty()) {
    const SolvedNeedle solved = solve_needle(path, ruptures);
    const Solution solution{path, solved, needle_covariance(solved)};
    const std::size_t worst = least_sure_rupture(solution);
    if (worst == ruptures.size()) {
      NeedleFit fit = fit_of(solution);
      fit.dropped = dropped;
      return fit;
    }
    ruptures.erase(ruptures.begin() + static_cast<std::ptrdiff_t>(worst));
    ++dropped;
  }
  throw InputError(
      "no sudden fall of the force during the insertion: no puncture is seen; "
      "palpate-fit curve fits a press");
}

}  // namespace palpate
