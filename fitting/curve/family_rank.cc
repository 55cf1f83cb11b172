#include "fitting/curve/family_rank.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <tuple>
#include <vector>

namespace palpate {
namespace {

constexpr std::string_view kMayFall = "interpolating";
constexpr double kDecisive = 30.0;  // of AICc: exp(-15) times as likely

// Whether the family that may fall follows so much better than all that may not, of
// those that do not miss, that it comes in its turn.
bool falls_decisively(const std::vector<FamilyFit>& fits) {
  double falling = std::numeric_limits<double>::infinity(), rising = falling;
  for (const FamilyFit& fit : fits) {
    if (!fit.misses && fit.converged) {
      double& least = fit.family == kMayFall ? falling : rising;
      least = std::min(least, fit.aicc);
    }
  }
  return falling + kDecisive < rising;
}

}  // namespace

void rank_fits(FamilyChoice& choice) {
  const auto n = static_cast<double>(choice.force_n.size());
  // AICc = D + 2 k n / (n - k - 1), BIC = D + k ln n, D the deviance.
  for (FamilyFit& fit : choice.fits) {
    const double k = fit.free_parameters;
    fit.aicc = n > k + 1.0 ? fit.deviance + 2.0 * k * n / (n - k - 1.0)
                           : std::numeric_limits<double>::infinity();
    fit.bic = fit.deviance + k * std::log(n);
  }
  const bool falls = falls_decisively(choice.fits);
  const auto rank = [&](const FamilyFit& fit) {
    const double score = fit.misses                               ? fit.rms_n
                         : choice.criterion == "bic"              ? fit.bic
                         : choice.criterion == "cross-validation" ? fit.cross_rms_n
                                                                  : fit.aicc;
    return std::tuple(!fit.converged, fit.misses,
                      !fit.misses && !falls && fit.family == kMayFall, score);
  };
  std::stable_sort(choice.fits.begin(), choice.fits.end(), [&](auto& a, auto& b) {
    return rank(a) < rank(b);
  });
}

}  // namespace palpate
