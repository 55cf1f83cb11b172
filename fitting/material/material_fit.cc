#include "fitting/material/material_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "fitting/material/material_solve.h"
#include "fitting/numerics/correlated_noise.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kLimit = 3.841459;      // 95 % of chi squared, one degree of freedom
constexpr int kProfileHalvings = 12;     // smallest step of a profile, of its side
constexpr double kDevianceMax = 30.0;    // farther out a profile says nothing new
constexpr double kBeyondSweepMax = 2.0;  // [-] of the sweep's depth
constexpr std::size_t kSamples = 200;    // per curve; more say no more

ScaledMaterialCurve scaled_curve(const ResponseSweep& sweep,
                                 const MaterialCurve& curve) {
  const Approach& a = curve.approach;
  const auto [low, high] = std::minmax_element(a.force_n.begin(), a.force_n.end());
  const auto deepest =
      std::max_element(a.displacement_m.begin(), a.displacement_m.end());
  const double travel_m = *deepest - curve.contact_point_m;
  if (!(travel_m > 0.0) || !(travel_m <= kBeyondSweepMax * sweep.depth_m.back())) {
    throw InputError(
        fmt::format("a curve goes {:.3g} m beyond its contact point, the sweep to "
                    "{:.3g} m: at most "
                    "twice as deep is allowed",
                    travel_m, sweep.depth_m.back()));
  }
  ScaledMaterialCurve result{.law = SweepInterpolation(sweep, curve.place)};
  result.length_m = travel_m;
  result.force_n = std::max(*high - *low, 1e-300);
  const std::size_t step = (a.force_n.size() + kSamples - 1) / kSamples;
  for (std::size_t i = 0; i < a.force_n.size(); i += step) {
    result.x.push_back((a.displacement_m[i] - curve.contact_point_m) / travel_m);
    result.f.push_back(a.force_n[i] / result.force_n);
  }
  return result;
}

// Standard deviation that residuals would have if each said as little alone as they do
// together.
double effective_sigma(const std::vector<double>& residual) {
  const Eigen::Map<const Eigen::VectorXd> r(residual.data(), std::ssize(residual));
  const double variance = long_run_variance(noises_of(Eigen::MatrixXd(r.size(), 0), r));
  return std::sqrt(std::max(variance, 1e-14));
}

MaterialBox box_of(const ResponseSweep& sweep) {
  MaterialBox box;
  const auto p = std::ssize(sweep.parameter);
  box.lower.resize(p);
  box.upper.resize(p);
  for (Eigen::Index j = 0; j < p; ++j) {
    const auto& grid = sweep.parameter[static_cast<std::size_t>(j)].value;
    box.lower[j] = std::log(grid.front());
    box.upper[j] = std::log(grid.back());
  }
  return box;
}

MaterialSolve best_of_starts(const std::vector<ScaledMaterialCurve>& curves,
                             const MaterialBox& box, double factor_sd) {
  MaterialSolve best;
  int iterations = 0;
  for (const double share : {0.5, 0.2, 0.8}) {
    const MaterialState start{
        box.lower + share * (box.upper - box.lower),
        std::vector<Eigen::Vector2d>(curves.size(), Eigen::Vector2d::Zero())};
    const MaterialSolve solve = solve_material(curves, start, box, factor_sd);
    iterations += solve.iterations;
    if (best.iterations == 0 || solve.squares < best.squares) {
      best = solve;
    }
  }
  best.iterations = iterations;
  return best;
}

bool at_edge(const MaterialBox& box, const Eigen::VectorXd& x, Eigen::Index j) {
  const double close = 1e-4 * (box.upper[j] - box.lower[j]);
  return x[j] - box.lower[j] < close || box.upper[j] - x[j] < close;
}

// From the best towards one edge of the sweep, each point from the one before.
std::vector<ProfilePoint> half_profile(const std::vector<ScaledMaterialCurve>& curves,
                                       const MaterialSolve& best,
                                       const MaterialBox& box, double factor_sd,
                                       int parameter, double edge) {
  std::vector<ProfilePoint> points;
  const double from = best.state.log_parameter[parameter];
  MaterialState state = best.state;
  for (int k = kProfileHalvings; k >= 0 && from != edge; --k) {
    // Steps double towards the edge. At each the other parameters are fitted again; the
    // deviance is what the squares grow by.
    state.log_parameter[parameter] = from + (edge - from) * std::pow(0.5, k);
    const MaterialSolve solve =
        solve_material(curves, state, box, factor_sd, parameter);
    state = solve.state;
    ProfilePoint point{std::exp(state.log_parameter[parameter]),
                       solve.squares - best.squares};
    for (Eigen::Index j = 0; j < state.log_parameter.size(); ++j) {
      point.other_at_bound = point.other_at_bound ||
                             (j != parameter && at_edge(box, state.log_parameter, j));
    }
    points.push_back(point);
    if (point.deviance > kDevianceMax) {
      break;
    }
  }
  return points;
}

// Where the profile passes kLimit, its root interpolated in the logarithm.
struct Crossing {
  double value = 0.0;
  bool found = false;
  bool other_at_bound = false;
};

Crossing crossing_of(const std::vector<ProfilePoint>& half, double best_value) {
  Crossing crossing{half.empty() ? best_value : half.back().value};
  double before = std::log(best_value);
  double root_before = 0.0;
  for (const ProfilePoint& point : half) {
    const double root = std::sqrt(std::max(point.deviance, 0.0));
    if (point.deviance > kLimit) {
      // The root of the deviance is linear in the logarithm where the squares are
      // quadratic.
      const double share = (std::sqrt(kLimit) - root_before) / (root - root_before);
      return {std::exp(before + share * (std::log(point.value) - before)), true,
              point.other_at_bound};
    }
    before = std::log(point.value);
    root_before = root;
  }
  return crossing;
}

std::string reason(const Crossing& low, const Crossing& high) {
  if (!low.found || !high.found) {
    return fmt::format(
        "not identifiable: the curves allow every value {} the sweep's edge",
        !low.found && !high.found ? "between the sweep's edges, both of"
        : low.found               ? "up to"
                                  : "down to");
  }
  if (low.other_at_bound || high.other_at_bound) {
    return "not identifiable alone: its interval ends only where another parameter "
           "meets the sweep's edge";
  }
  return "";
}

MaterialParameter judged(const std::vector<ScaledMaterialCurve>& curves,
                         const MaterialSolve& best, const MaterialBox& box,
                         double factor_sd, int j, const std::string& name) {
  MaterialParameter result{.name = name};
  result.value = std::exp(best.state.log_parameter[j]);
  const auto down = half_profile(curves, best, box, factor_sd, j, box.lower[j]);
  const auto up = half_profile(curves, best, box, factor_sd, j, box.upper[j]);
  const Crossing low = crossing_of(down, result.value);
  const Crossing high = crossing_of(up, result.value);
  result.low = low.value;
  result.high = high.value;
  result.why_not = reason(low, high);
  result.identifiable = result.why_not.empty();
  result.profile.assign(down.rbegin(), down.rend());
  result.profile.push_back({result.value, 0.0});
  result.profile.insert(result.profile.end(), up.begin(), up.end());
  return result;
}

}  // namespace

MaterialFit fit_material(const ResponseSweep& sweep,
                         std::span<const MaterialCurve> curves) {
  const auto begin = std::chrono::steady_clock::now();
  if (curves.empty()) {
    throw InputError("material fit: no curves");
  }
  std::vector<ScaledMaterialCurve> scaled_curves;
  for (const MaterialCurve& curve : curves) {
    scaled_curves.push_back(scaled_curve(sweep, curve));
  }
  const MaterialBox box = box_of(sweep);
  const double factor_sd = std::log1p(sweep.error_relative);
  // 1. The best of three starts, all residuals of the same sd.
  MaterialSolve best = best_of_starts(scaled_curves, box, factor_sd);
  MaterialFit fit;
  fit.iterations = best.iterations;
  // 2. Each curve's sd from its residuals, so that correlated samples do not count as
  //    many.
  for (std::size_t c = 0; c < curves.size(); ++c) {
    scaled_curves[c].sigma =
        effective_sigma(material_residuals(scaled_curves[c], best.state, c));
  }
  // 3. The fit with these, its covariance, and a profile of each parameter.
  best = solve_material(scaled_curves, best.state, box, factor_sd);
  fit.iterations += best.iterations;
  fit.converged = best.converged;
  const Eigen::MatrixXd covariance =
      material_covariance(scaled_curves, best.state, factor_sd);
  const Eigen::VectorXd sd = covariance.diagonal().cwiseSqrt();
  fit.correlation =
      sd.cwiseInverse().asDiagonal() * covariance * sd.cwiseInverse().asDiagonal();
  for (int j = 0; j < static_cast<int>(sd.size()); ++j) {
    fit.parameter.push_back(judged(scaled_curves, best, box, factor_sd, j,
                                   sweep.parameter[static_cast<std::size_t>(j)].name));
    fit.parameter.back().sd_log = sd[j];
  }
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const ScaledMaterialCurve& curve = scaled_curves[c];
    double squares = 0.0;
    for (const double r : material_residuals(curve, best.state, c)) {
      squares += r * r;
    }
    fit.rms_n.push_back(curve.force_n *
                        std::sqrt(squares / static_cast<double>(curve.x.size())));
    fit.contact_point_m.push_back(curves[c].contact_point_m +
                                  curve.length_m * best.state.contact_baseline[c][0]);
  }
  fit.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

}  // namespace palpate
