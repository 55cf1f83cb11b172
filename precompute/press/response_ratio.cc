#include "precompute/press/response_ratio.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/base/reproducible.h"
#include "formats/response/force_difference.h"

namespace palpate {
namespace {

constexpr std::size_t kNeighbours = 6;
// Contact radii that normals a radian apart count as, or stiffnesses e times apart.
constexpr double kAlikeRadii = 4.0;
// Energy that laws add which counts as a stiffness e times as large.
constexpr double kAlikeEnergy = 0.25;
constexpr double kNoForce = 1e-9;  // of the largest force: rounding, not contact
// Presses of one vertex on one mesh that differ by more do not follow one mechanism.
constexpr double kAlike = 10.0;
constexpr double kUnlikeError = 1.0;

double past_touch_m(const Indentation& path, std::size_t k) {
  return path.sample[k].penetration_m - path.sample.front().penetration_m;
}

Eigen::VectorXd error_weights(const Indentation& path) {
  const std::size_t n = path.sample.size() - 1;
  const double largest = path.sample.back().force_n.norm();
  Eigen::VectorXd weight(static_cast<Eigen::Index>(n));
  for (std::size_t k = 1; k <= n; ++k) {
    const double share = path.sample[k].force_n.norm() / largest;
    const bool counts =
        path.sample[k].penetration_m >= kErrorCountsFrom * path.sample[n].penetration_m;
    weight[static_cast<Eigen::Index>(k - 1)] =
        counts ? std::min(1.0, share / kErrorCountsFrom) : 0.0;
  }
  return weight;
}

double ratio_difference(const PathRatio& a, const PathRatio& b) {
  const Eigen::Index n = std::min(a.force.size(), b.force.size());
  return ((a.force.head(n).array() / b.force.head(n).array() - 1.0) *
          b.weight.head(n).array())
      .matrix()
      .lpNorm<Eigen::Infinity>();
}

}  // namespace

bool is_guide(const Indentation& path) {
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

std::optional<PathRatio> path_ratio(const Indentation& good, const Indentation& cheap) {
  if (!is_guide(good) || !is_guide(cheap)) {
    return std::nullopt;
  }
  const auto samples = static_cast<Eigen::Index>(cheap.sample.size() - 1);
  PathRatio ratio{.force = Eigen::VectorXd(samples),
                  .turn = Eigen::MatrixX3d(samples, 3),
                  .weight = error_weights(cheap),
                  .hard_share = good.hard_path ? 1.0 : 0.0};
  for (Eigen::Index i = 0; i < samples; ++i) {
    const std::size_t k =
        std::min(static_cast<std::size_t>(i) + 1, good.sample.size() - 1);
    const Eigen::Vector3d& good_n = good.sample[k].force_n;
    const Eigen::Vector3d& cheap_n = cheap.sample[k].force_n;
    ratio.force[i] = good_n.norm() / cheap_n.norm();
    ratio.turn.row(i) = good_n.normalized() - cheap_n.normalized();
  }
  if (!(ratio.force.minCoeff() > 1.0 / kAlike && ratio.force.maxCoeff() < kAlike)) {
    return std::nullopt;
  }
  return ratio;
}

Indentation scaled(const Indentation& cheap, const PathRatio& ratio,
                   double force_max_n) {
  Indentation path = cheap;
  path.force_capped = false;
  path.hard_path = ratio.hard_share >= 0.5;
  for (std::size_t k = 1; k < path.sample.size() && !path.force_capped; ++k) {
    IndentationSample& sample = path.sample[k];
    const auto i = std::min(static_cast<Eigen::Index>(k), ratio.force.size()) - 1;
    const double force_n = sample.force_n.norm() * ratio.force[i];
    sample.force_n.normalize();
    if (ratio.turn.rows() > i) {
      sample.force_n = (sample.force_n + ratio.turn.row(i).transpose()).normalized();
    }
    sample.force_n *= force_n;
    sample.coarse_force_n *= ratio.force[i];
    sample.energy_j *= ratio.force[i];
    if (force_n > force_max_n) {
      path.force_capped = true;
      path.sample.resize(k + 1);
    }
  }
  return path;
}

RatioField::Place RatioField::place_of(std::int32_t vertex, const Indentation& cheap) {
  // Of the secant at the path's end.
  const double force_n =
      std::max(cheap.sample.back().force_n.norm(), std::numeric_limits<double>::min());
  return {vertex,
          reproducible::log(force_n / past_touch_m(cheap, cheap.sample.size() - 1)),
          cheap.nonlinearity};
}

void RatioField::add(std::int32_t vertex, const Indentation& cheap,
                     std::optional<PathRatio> ratio) {
  ratios_ += ratio ? 1 : 0;
  known_.push_back({place_of(vertex, cheap), std::move(ratio)});
}

double RatioField::distance_m(std::int32_t a, const Indentation& cheap_a,
                              std::int32_t b, const Indentation& cheap_b) const {
  return distance_m(place_of(a, cheap_a), place_of(b, cheap_b));
}

double RatioField::unlikeness(std::int32_t a, const Indentation& cheap_a,
                              std::int32_t b, const Indentation& cheap_b) const {
  return unlikeness(place_of(a, cheap_a), place_of(b, cheap_b));
}

double RatioField::unlikeness(const Place& a, const Place& b) const {
  const double turned = (normal_.row(a.vertex) - normal_.row(b.vertex)).norm();
  const double stiffer = a.log_stiffness - b.log_stiffness;
  const double bent = (a.nonlinearity - b.nonlinearity) / kAlikeEnergy;
  return std::hypot(turned, stiffer, bent);
}

double RatioField::distance_m(const Place& a, const Place& b) const {
  const double away =
      (surface_.position_m.row(a.vertex) - surface_.position_m.row(b.vertex)).norm();
  return std::hypot(away, kAlikeRadii * contact_m_ * unlikeness(a, b));
}

std::vector<RatioField::Weight> RatioField::weights(const Place& place,
                                                    std::int32_t without, Of of) const {
  std::vector<Weight> weights;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (known_[i].place.vertex != without && (of == Of::kAll || known_[i].ratio)) {
      weights.push_back({i, 0.0, distance_m(place, known_[i].place)});
    }
  }
  const std::size_t kept = std::min(kNeighbours, weights.size());
  std::partial_sort(weights.begin(),
                    weights.begin() + static_cast<std::ptrdiff_t>(kept), weights.end(),
                    [](const Weight& a, const Weight& b) {
                      return a.distance_m < b.distance_m;
                    });
  weights.resize(kept);
  double sum = 0.0;
  for (Weight& w : weights) {
    w.weight = 1.0 / (w.distance_m * w.distance_m + 1e-300);
    sum += w.weight;
  }
  for (Weight& w : weights) {
    w.weight /= sum;
  }
  return weights;
}

PathRatio RatioField::at(std::int32_t vertex, const Indentation& cheap,
                         std::int32_t without) const {
  return mean_at(place_of(vertex, cheap), without);
}

PathRatio RatioField::mean_at(const Place& place, std::int32_t without) const {
  PathRatio mean;
  for (const Weight& w : weights(place, without, Of::kRatios)) {
    const PathRatio& ratio = *known_[w.known].ratio;
    mean.hard_share += w.weight * ratio.hard_share;
    if (mean.force.size() < ratio.force.size()) {
      // A longer path goes on where shorter ones end.
      const Eigen::Index before = mean.force.size();
      mean.force.conservativeResize(ratio.force.size());
      mean.force.tail(ratio.force.size() - before)
          .setConstant(before > 0 ? mean.force[before - 1] : 0.0);
    }
    for (Eigen::Index k = 0; k < mean.force.size(); ++k) {
      mean.force[k] += w.weight * ratio.force[std::min(k, ratio.force.size() - 1)];
    }
  }
  return mean;
}

std::vector<double> RatioField::leave_one_out() const {
  std::vector<double> errors;
  for (const Known& known : known_) {
    errors.push_back(
        known.ratio && ratios_ > 1
            ? ratio_difference(mean_at(known.place, known.place.vertex), *known.ratio)
            : kUnlikeError);
  }
  return errors;
}

double RatioField::error_at(std::int32_t vertex, const Indentation& cheap,
                            std::span<const double> leave_one_out) const {
  double sum = 0.0;
  for (const Weight& w : weights(place_of(vertex, cheap), -1, Of::kAll)) {
    sum += w.weight * leave_one_out[w.known] * leave_one_out[w.known];
  }
  return std::sqrt(sum);
}

}  // namespace palpate
