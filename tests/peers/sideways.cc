#include "tests/peers/sideways.h"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace palpate::peers {
namespace {

bool evenly_spaced(const std::vector<TruePoint>& points) {
  for (std::size_t i = 2; i < points.size(); ++i) {
    if (points[i].tick - points[i - 1].tick != points[1].tick - points[0].tick) {
      return false;
    }
  }
  return points.size() > 2;
}

}  // namespace

double MeanSquares::rms(double low_hz, double high_hz) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < mean_squares.size(); ++k) {
    const double hz = static_cast<double>(k + 1) * step_hz;
    sum += hz >= low_hz && hz < high_hz ? mean_squares[k] : 0.0;
  }
  return std::sqrt(sum);
}

MeanSquares mean_squares(std::span<const Eigen::Vector3d> signal, double interval_s) {
  const std::size_t n = signal.size();
  // e^{-2 pi j i / n}; its real part makes the window.
  std::vector<std::complex<double>> turn(n);
  std::vector<Eigen::Vector3d> faded(n);
  double squared_window = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    turn[i] = std::polar(
        1.0, -2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
    const double window = 0.5 * (1.0 - turn[i].real());
    faded[i] = window * signal[i];
    squared_window += window * window;
  }
  MeanSquares all{1.0 / (static_cast<double>(n) * interval_s), {}};
  for (std::size_t k = 1; 2 * k < n; ++k) {
    Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      sum += turn[k * i % n] * faded[i];
    }
    all.mean_squares.push_back(2.0 * sum.squaredNorm() /
                               (static_cast<double>(n) * squared_window));
  }
  return all;
}

std::vector<Eigen::Vector3d> sideways_n(std::span<const Eigen::Vector3d> force_n,
                                        std::span<const Eigen::Vector3d> outward) {
  std::vector<Eigen::Vector3d> across;
  for (std::size_t i = 0; i < force_n.size(); ++i) {
    across.push_back(force_n[i] - force_n[i].dot(outward[i]) * outward[i]);
  }
  return across;
}

Sideways sideways(const RenderedHand& rendered) {
  const Hand& hand = *rendered.hand;
  if (!evenly_spaced(hand.dense_truth)) {
    return {};
  }
  const std::int64_t apart = hand.dense_truth[1].tick - hand.dense_truth[0].tick;
  const auto first = static_cast<std::size_t>(hand.dense_truth.front().tick);
  const auto count =
      static_cast<std::size_t>(hand.dense_truth.back().tick) - first;  // without it
  std::vector<Eigen::Vector3d> force_n;
  std::vector<Eigen::Vector3d> outward;
  for (std::size_t i = 0; i + 1 < hand.dense_truth.size(); ++i) {
    force_n.push_back(hand.dense_truth[i].force_n);
    outward.push_back(hand.outward[static_cast<std::size_t>(hand.dense_truth[i].tick)]);
  }
  return {mean_squares(sideways_n(std::span(rendered.force_n).subspan(first, count),
                                  std::span(hand.outward).subspan(first, count)),
                       kHandTickS),
          mean_squares(sideways_n(force_n, outward),
                       static_cast<double>(apart) * kHandTickS)};
}

Roughness roughness(const Sideways& s) {
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  Roughness rough;
  if (!s.truth.mean_squares.empty()) {
    rough.rendered_n = s.rendered.rms(kRoughHz, kNoEnd);
    rough.true_n = s.truth.rms(kRoughHz, kNoEnd);
  }
  if (rough.true_n >= kSmoothN) {
    rough.ratio = rough.rendered_n / rough.true_n;
  }
  return rough;
}

}  // namespace palpate::peers
