#include "fitting/curve/frame_compliance.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr std::size_t kFirstSamples = 5;

double free_force_n(const std::vector<double>& force_n, std::size_t first_n) {
  const auto few = std::min(kFirstSamples, first_n);
  return median({force_n.begin(), force_n.begin() + static_cast<std::ptrdiff_t>(few)});
}

// What machine and frame moved while the force rose from half to its largest: free
// travel would hide there that nothing is left for the sample.
void check_left_over(const FrameCompliance& frame, const Measurement& m,
                     std::size_t first_n, double free_n) {
  const auto first = m.force_n.begin();
  const auto peak =
      std::max_element(first, first + static_cast<std::ptrdiff_t>(first_n)) - first;
  const auto top = static_cast<std::size_t>(peak);
  const double most = m.force_n[top] - free_n;
  std::size_t half = top;
  while (half > 0 && m.force_n[half] - free_n > 0.5 * most) {
    --half;
  }
  const double moved = m.depth_m[top] - m.depth_m[half];
  const double taken =
      deflection_m(frame, most) - deflection_m(frame, m.force_n[half] - free_n);
  const double noise = noise_standard_deviation(std::span(m.force_n).first(first_n));
  if (most > 10.0 * noise && !(taken < moved)) {
    throw InputError(fmt::format(
        "the frame takes the whole displacement: from {:.3g} N to {:.3g} N the machine "
        "moves {:.4g} m and a frame of {:.4g} N/m {:.4g} m; its stiffness must be more "
        "than {:.4g} N/m, if displacement and force are in the units stated",
        m.force_n[half] - free_n, most, moved, frame.stiffness_n_per_m, taken,
        frame.stiffness_n_per_m * taken / moved));
  }
}

}  // namespace

FrameCompliance linear_frame(double stiffness_n_per_m, double sd_n_per_m) {
  if (!(stiffness_n_per_m > 0.0) || !std::isfinite(stiffness_n_per_m) ||
      sd_n_per_m < 0.0 || std::isinf(sd_n_per_m)) {
    throw InputError(
        fmt::format("a frame's stiffness is {} N/m{}, must be positive and finite, its "
                    "standard deviation zero or more",
                    stiffness_n_per_m,
                    std::isnan(sd_n_per_m) ? "" : fmt::format(" +- {}", sd_n_per_m)));
  }
  FrameCompliance frame;
  frame.force_n = {0.0, 1.0};
  frame.deflection_m = {0.0, 1.0 / stiffness_n_per_m};
  frame.stiffness_n_per_m = stiffness_n_per_m;
  frame.stiffness_sd_n_per_m = sd_n_per_m;
  return frame;
}

double deflection_m(const FrameCompliance& frame, double force_n) {
  const auto& f = frame.force_n;
  const auto& u = frame.deflection_m;
  const double size = std::abs(force_n);
  const auto above = std::upper_bound(f.begin() + 1, f.end() - 1, size) - f.begin();
  const auto k = static_cast<std::size_t>(above);
  const double slope = (u[k] - u[k - 1]) / (f[k] - f[k - 1]);
  return std::copysign(u[k - 1] + slope * (size - f[k - 1]), force_n);
}

FrameCompliance softer(const FrameCompliance& frame) {
  FrameCompliance result = frame;
  const double more = 1.0 + frame.stiffness_sd_n_per_m / frame.stiffness_n_per_m;
  for (double& u : result.deflection_m) {
    u *= more;
  }
  result.stiffness_n_per_m /= more;
  return result;
}

void take_off_deflection(const FrameCompliance& frame, std::size_t first_n,
                         Measurement& measurement) {
  const double free_n = free_force_n(measurement.force_n, first_n);
  const auto& f = measurement.force_n;
  const double largest = *std::max_element(f.begin(), f.end()) - free_n;
  if (!frame.linear && largest > kFrameForceBeyond * frame.force_n.back()) {
    throw InputError(fmt::format(
        "the force reaches {:.4g} N; the frame, whose stiffness is not constant, was "
        "measured up to {:.4g} N: press the rigid plate at least as hard",
        largest, frame.force_n.back()));
  }
  check_left_over(frame, measurement, first_n, free_n);
  for (std::size_t i = 0; i < f.size(); ++i) {
    measurement.depth_m[i] -= deflection_m(frame, f[i] - free_n);
  }
}

}  // namespace palpate
