#include "precompute/press/interpolation_error.h"

#include <algorithm>
#include <vector>

#include "formats/response/force_difference.h"

namespace palpate {
namespace {

std::span<const IndentationSample>::iterator sample_at(
    std::span<const IndentationSample> path, double penetration_m) {
  return std::lower_bound(path.begin(), path.end(), penetration_m,
                          [](const IndentationSample& sample, double x) {
                            return sample.penetration_m < x;
                          });
}

}  // namespace

double interpolation_error(std::span<const IndentationSample> path,
                           std::span<const RelativeCorrection::Knot> knots) {
  const double largest_n =
      path.back().force_n.norm() * (1.0 + knots.back().value.norm());
  double largest = 0.0;
  auto at = path.begin();
  auto before = at;  // of the knot before
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    before = at;
    at = sample_at(path, knots[k].penetration_m);
    const auto after = sample_at(path, knots[k + 1].penetration_m);
    const double to_m = at->penetration_m - before->penetration_m;
    const double from_m = after->penetration_m - at->penetration_m;
    const double longest_m = std::max(at - before > 1 ? to_m : 0.0,  // interpolated
                                      after - at > 1 ? from_m : 0.0);
    // A knot left out is missed by about h1 h2 / 2 times the correction's second
    // derivative. Halfway between knots h apart the error is h^2 / 8 times that: a
    // share h^2 / (4 h1 h2).
    const double beside = 0.25 * longest_m * longest_m / (to_m * from_m);
    std::vector<RelativeCorrection::Knot> others(knots.begin(), knots.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const RelativeCorrection without(path.front().penetration_m, others);
    const double force_n = at->force_n.norm();
    const double off_n =
        force_n * (without.at(knots[k].penetration_m) - knots[k].value).norm();
    largest = std::max(
        largest, beside * off_n / std::max(force_n, kErrorCountsFrom * largest_n));
  }
  return largest;
}

}  // namespace palpate
