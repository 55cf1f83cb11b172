#include "fitting/curve/fit_rating.h"

#include <algorithm>
#include <cmath>

#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr double kDepthMin = 1e-9, kDepthMax = 0.5;   // [m]
constexpr double kForceMin = 1e-12, kForceMax = 1e5;  // [N]

// Wald and Wolfowitz: changes of sign, less those of independent signs, over their
// standard deviation.
double runs_z(const std::vector<double>& residuals) {
  double above = 0.0, below = 0.0, runs = residuals.empty() ? 0.0 : 1.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    (residuals[i] > 0.0 ? above : below) += 1.0;
    if (i > 0 && (residuals[i] > 0.0) != (residuals[i - 1] > 0.0)) {
      runs += 1.0;
    }
  }
  // Number of runs of one sign: mean 2 a b / n + 1, variance (m - 1)(m - 2) / (n - 1).
  const double n = above + below, expected = 2.0 * above * below / n + 1.0;
  const double variance = (expected - 1.0) * (expected - 2.0) / (n - 1.0);
  return variance > 0.0 ? (runs - expected) / std::sqrt(variance) : 0.0;
}

double correlation_max(const Eigen::MatrixXd& covariance) {
  double most = 0.0;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double both = covariance(i, i) * covariance(j, j);
      if (both > 0.0) {
        most = std::max(most, std::abs(covariance(i, j)) / std::sqrt(both));
      }
    }
  }
  return most;
}

RatingFeatures rating_features(const FamilyChoice& choice) {
  const FamilyFit& fit = choice.fits.front();
  RatingFeatures features;
  std::vector<double> residual, near;
  for (std::size_t i = 0; i < choice.force_n.size(); ++i) {
    const double x = choice.displacement_m[i], d = x - fit.contact_point_m;
    residual.push_back(choice.force_n[i] - fitted_force_n(fit, x));
    if (d >= 0.0 && d <= 0.1 * fit.depth_max_m) {
      near.push_back(residual.back());
    }
    features.samples_in_contact += d >= 0.0 ? 1 : 0;
  }
  const double noise = std::max(choice.noise_sd_n, 1e-6 * fit.force_n);
  features.rms_over_noise = fit.rms_n / noise;
  features.runs_z = runs_z(residual);
  features.near_contact_over_noise = near.empty() ? 0.0 : rms(near) / noise;
  features.correlation_max = correlation_max(fit.covariance);
  return features;
}

bool bound_matters(const FamilyFit& fit) {
  return std::any_of(fit.at_bound.begin(), fit.at_bound.end(), [](const auto& name) {
    return name == "contact_point" || name == "exponent" || name == "l" || name == "d1";
  });
}

}  // namespace

void take_misfit(const FamilyChoice& choice, std::vector<FitFlag>& flags) {
  std::erase(flags, FitFlag::kMisfit);
  if (!choice.fits.empty() && choice.fits.front().misses) {
    flags.push_back(FitFlag::kMisfit);
  }
}

std::string_view verdict_name(Verdict verdict) noexcept {
  return verdict == Verdict::kUse     ? "use"
         : verdict == Verdict::kCheck ? "check"
                                      : "skip";
}

Rating rate(const ContactFit& fit, const FamilyChoice& choice) {
  Rating rating;
  if (fit.has(FitFlag::kEmptyRun) || choice.fits.empty()) {
    rating.gates.emplace_back("empty_run");
    return rating;
  }
  const FamilyFit& best = choice.fits.front();
  rating.features = rating_features(choice);
  if (rating.features.samples_in_contact < kSamplesMin) {
    rating.gates.emplace_back("too_few_samples");
  }
  if (!(best.depth_max_m >= kDepthMin && best.depth_max_m <= kDepthMax &&
        best.force_n >= kForceMin && best.force_n <= kForceMax)) {
    rating.gates.emplace_back("implausible_units");
  }
  if (!best.converged) {
    rating.gates.emplace_back("not_converged");
  }
  if (!rating.gates.empty()) {
    return rating;
  }
  // The gates before end the rating; each of those that follow halves the score.
  for (const FitFlag flag :
       {FitFlag::kAlreadyInContact, FitFlag::kContactPointNotIdentified,
        FitFlag::kForceRisesInHold, FitFlag::kNonMonotoneDepth,
        FitFlag::kNonPassiveLoop, FitFlag::kAdhesion, FitFlag::kFrameTakesMost}) {
    if (fit.has(flag)) {
      rating.gates.emplace_back(flag_name(flag));
    }
  }
  if (best.misses) {
    rating.gates.emplace_back(flag_name(FitFlag::kMisfit));
  }
  for (const CurveFeature& feature : choice.features) {
    if (feature.kind == FeatureKind::kFall || feature.kind == FeatureKind::kClipped) {
      rating.gates.emplace_back(feature_name(feature.kind));
    }
  }
  if (bound_matters(best)) {
    rating.gates.emplace_back(flag_name(FitFlag::kParameterAtBound));
  }
  // Score: a product of 1 / (1 + excess / scale) times 2^-gates.
  const auto penalty = [](double excess, double scale) {
    return 1.0 / (1.0 + std::max(0.0, excess) / scale);
  };
  rating.score = penalty(rating.features.rms_over_noise - 1.0, 5.0) *
                 penalty(rating.features.near_contact_over_noise - 1.0, 5.0) *
                 penalty(-rating.features.runs_z, 20.0) *
                 std::pow(0.5, static_cast<double>(rating.gates.size()));
  rating.verdict = rating.gates.empty() ? Verdict::kUse : Verdict::kCheck;
  return rating;
}

}  // namespace palpate
