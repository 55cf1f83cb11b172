#include "precompute/press/response_ratio.h"

#include <algorithm>
#include <cmath>

#include "formats/response/force_difference.h"

namespace palpate {
namespace {

constexpr double kNoForce = 1e-9;  // of the largest force: rounding, not contact
// Presses of one vertex on one mesh that differ by more do not follow one mechanism.
constexpr double kAlike = 10.0;

Eigen::VectorXd error_weights(const Indentation& path) {
  const std::size_t n = path.sample.size() - 1;
  const double largest = path.sample.back().force_n.norm();
  Eigen::VectorXd weight(static_cast<Eigen::Index>(n));
  for (std::size_t k = 1; k <= n; ++k) {
    // Errors count in full from a share of the last force on, below it in proportion to
    // the force. At small penetrations they do not count.
    const double share = path.sample[k].force_n.norm() / largest;
    const bool counts =
        path.sample[k].penetration_m >= kErrorCountsFrom * path.sample[n].penetration_m;
    weight[static_cast<Eigen::Index>(k - 1)] =
        counts ? std::min(1.0, share / kErrorCountsFrom) : 0.0;
  }
  return weight;
}

}  // namespace

bool is_predictor(const Indentation& path) {
  double largest = 0.0;
  for (const IndentationSample& sample : path.sample) {
    largest = std::max(largest, sample.force_n.norm());
  }
  return path.sample.size() >= 3 && std::isfinite(largest) &&
         std::all_of(path.sample.begin() + 1, path.sample.end(),
                     [&](const IndentationSample& sample) {
                       return std::isfinite(sample.penetration_m) &&
                              sample.force_n.norm() > kNoForce * largest;
                     });
}

std::optional<PathRatio> path_ratio(const Indentation& full,
                                    const Indentation& linear) {
  if (!is_predictor(full) || !is_predictor(linear)) {
    return std::nullopt;
  }
  const auto samples = static_cast<Eigen::Index>(linear.sample.size() - 1);
  PathRatio ratio{.force = Eigen::VectorXd(samples),
                  .turn = Eigen::MatrixX3d(samples, 3),
                  .weight = error_weights(linear),
                  .hard_share = full.near_singular ? 1.0 : 0.0};
  for (Eigen::Index i = 0; i < samples; ++i) {
    // A full path that ends early goes on with its last ratio.
    const std::size_t k =
        std::min(static_cast<std::size_t>(i) + 1, full.sample.size() - 1);
    const Eigen::Vector3d& full_n = full.sample[k].force_n;
    const Eigen::Vector3d& linear_n = linear.sample[k].force_n;
    ratio.force[i] = full_n.norm() / linear_n.norm();
    ratio.turn.row(i) = full_n.normalized() - linear_n.normalized();
  }
  if (!(ratio.force.minCoeff() > 1.0 / kAlike && ratio.force.maxCoeff() < kAlike)) {
    return std::nullopt;
  }
  return ratio;
}

Indentation scaled(const Indentation& linear, const PathRatio& ratio,
                   double force_max_n) {
  Indentation path = linear;
  path.force_capped = false;
  path.near_singular = ratio.hard_share >= 0.5;
  for (std::size_t k = 1; k < path.sample.size() && !path.force_capped; ++k) {
    IndentationSample& sample = path.sample[k];
    const auto i = std::min(static_cast<Eigen::Index>(k), ratio.force.size()) - 1;
    const double force_n = sample.force_n.norm() * ratio.force[i];
    // F = r |F_linear| (u + turn) / |u + turn|, u the linear force's direction.
    sample.force_n =
        force_n *
        (sample.force_n.normalized() + ratio.turn.row(i).transpose()).normalized();
    sample.coarse_force_n *= ratio.force[i];
    sample.energy_j *= ratio.force[i];
    if (force_n > force_max_n) {
      path.force_capped = true;
      path.sample.resize(k + 1);
    }
  }
  path.ends_early = linear.force_capped && !path.force_capped;
  return path;
}

}  // namespace palpate
