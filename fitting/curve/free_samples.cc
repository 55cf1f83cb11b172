#include "fitting/curve/free_samples.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kDeviations = 3.0;
constexpr double kDepthShare = 0.02;  // [-] of the largest depth

}  // namespace

FreeSamples free_samples(const Measurement& turned, const Approach& approach,
                         const ContactFit& fit) {
  FreeSamples free;
  if (fit.has(FitFlag::kEmptyRun) || fit.has(FitFlag::kAlreadyInContact)) {
    return free;
  }
  const double sd = std::isfinite(fit.contact.sd_m) ? fit.contact.sd_m : 0.0;
  const double limit =
      fit.contact.m - std::max(kDeviations * sd, kDepthShare * fit.depth_max_m);
  for (std::size_t i = 0; i < turned.depth_m.size(); ++i) {
    if (turned.depth_m[i] < limit) {
      (i < approach.samples ? free.before : free.after).push_back(i);
    }
  }
  const auto half = static_cast<std::ptrdiff_t>((free.after.size() + 1) / 2);
  free.after.erase(free.after.begin(), free.after.begin() + half);
  return free;
}

}  // namespace palpate
