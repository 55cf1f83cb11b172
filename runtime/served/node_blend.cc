#include "runtime/served/node_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "runtime/slow/thinned_curve.h"

namespace palpate {
namespace {

Eigen::Vector3d vector(const std::array<double, 3>& values) {
  return Eigen::Map<const Eigen::Vector3d>(values.data());
}

// c.
double lean(const ElementNode& node) {
  return std::abs(vector(node.normal).dot(vector(node.direction)));
}

double penetration_m(const ElementNode& node, double depth_m) {
  return node.touch_offset_m + depth_m / lean(node);
}

// g, g' and the energy at a penetration.
ResponseSample along_normal(const ElementNode& node, double at_m) {
  if (node.samples == 0) {
    return {};
  }
  const double c = lean(node);
  const ResponseSample at = node.curve().at(c * (at_m - node.touch_offset_m));
  return {c * at.force_n, c * c * at.stiffness_n_per_m, at.energy_j, at.extrapolated};
}

// g' at a knot. A curve that begins past the first knot does so with slope 0: with its
// own one the cubic before would dip below zero, and energies with it.
double slope_at(const ElementNode& node, double at_m, double first_m) {
  if (node.samples == 0 || at_m < node.touch_offset_m ||
      (at_m == node.touch_offset_m && at_m > first_m)) {
    return 0.0;
  }
  const double c = lean(node);
  if (at_m == node.touch_offset_m) {
    return c * c * node.stiffness_n_per_m[0];
  }
  return along_normal(node, at_m).stiffness_n_per_m;
}

// A response that is not there takes the other's place: one of zero force.
ElementNode zero_beside(const ElementNode& none, const ElementNode& other) {
  ElementNode zero = none;
  zero.direction = other.direction;
  zero.tilt = other.tilt;
  zero.tilt_by_height_per_m = other.tilt_by_height_per_m;
  zero.touch_offset_m = other.touch_offset_m;
  zero.samples = other.samples;
  zero.depth_m = other.depth_m;
  zero.force_n.fill(0.0);
  zero.stiffness_n_per_m.fill(0.0);
  zero.energy_j.fill(0.0);
  return zero;
}

void add_samples(const ElementNode& node, std::vector<double>& at_m) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(node.samples); ++i) {
    at_m.push_back(penetration_m(node, node.depth_m[i]));
  }
}

// Knots nearer than this are one: a millionth of the whole.
constexpr double kSame = 1e-6;

// Sorted, none twice, at most kElementSamples: of too many, those go whose neighbours
// are nearest.
void thin(std::vector<double>& at_m) {
  std::sort(at_m.begin(), at_m.end());
  const double same_m = kSame * (at_m.back() - at_m.front());
  const double last_m = at_m.back();
  std::vector<double> kept;
  for (const double at : at_m) {
    if (kept.empty() || at - kept.back() > same_m) {
      kept.push_back(at);
    }
  }
  kept.back() = last_m;
  while (kept.size() > kElementSamples) {
    std::size_t closest = 1;
    for (std::size_t i = 1; i + 1 < kept.size(); ++i) {
      if (kept[i + 1] - kept[i - 1] < kept[closest + 1] - kept[closest - 1]) {
        closest = i;
      }
    }
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(closest));
  }
  at_m = std::move(kept);
}

}  // namespace

double largest_normal_force_n(const ElementNode& node) noexcept {
  double largest = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(node.samples); ++i) {
    largest = std::max(largest, std::abs(node.force_n[i]));
  }
  return largest * lean(node);
}

NodeBlend::NodeBlend(const ElementNode& from, const ElementNode& to, double reach_m)
    : from_(from.samples > 0 || to.samples == 0 ? from : zero_beside(from, to)),
      to_(to),
      now_(from),
      largest_n_(std::max(largest_normal_force_n(from), largest_normal_force_n(to))) {
  if (from.samples == 0 && to.samples == 0) {
    share_ = 1.0;
    return;
  }
  choose_knots();
  measure(reach_m);
}

void NodeBlend::choose_knots() {
  // What fades away keeps its direction.
  const ElementNode end = to_.samples > 0 ? to_ : zero_beside(to_, from_);
  std::vector<double> at_m;
  add_samples(from_, at_m);
  add_samples(end, at_m);
  const ElementNode& later = from_.touch_offset_m > end.touch_offset_m ? from_ : end;
  if (from_.touch_offset_m != end.touch_offset_m) {
    // Soon after it begins it has the slope that it begins with.
    constexpr double kSoon = 0.05;  // of its first interval
    at_m.push_back(penetration_m(later, kSoon * later.depth_m[1]));
  }
  thin(at_m);
  knots_ = at_m.size();
  for (std::size_t k = 0; k < knots_; ++k) {
    knot_[k] = {.penetration_m = at_m[k],
                .force_n = {along_normal(from_, at_m[k]).force_n,
                            along_normal(end, at_m[k]).force_n},
                .stiffness_n_per_m = {slope_at(from_, at_m[k], at_m[0]),
                                      slope_at(end, at_m[k], at_m[0])}};
  }
}

void NodeBlend::measure(double reach_m) {
  const auto differ = [&](double at_m) {
    const ResponseSample a = along_normal(from_, at_m);
    const ResponseSample b = along_normal(to_, at_m);
    change_n_ = std::max(
        {change_n_, std::numbers::sqrt2 * std::abs(b.force_n - a.force_n),
         2.0 * std::numbers::sqrt2 * std::abs(b.energy_j - a.energy_j) / reach_m});
  };
  for (std::size_t k = 0; k < knots_; ++k) {
    differ(knot_[k].penetration_m);
    if (k > 0) {
      differ(0.5 * (knot_[k - 1].penetration_m + knot_[k].penetration_m));
    }
  }
}

const ElementNode& NodeBlend::step(double most_n) {
  const double left = 1.0 - share_;
  if (change_n_ * left <= most_n) {
    share_ = 1.0;
    now_ = to_;
    return now_;
  }
  share_ += most_n / change_n_;
  set_now();
  return now_;
}

void NodeBlend::set_now() {
  const ElementNode& end = to_.samples > 0 ? to_ : from_;
  const Eigen::Vector3d u =
      ((1.0 - share_) * vector(from_.direction) + share_ * vector(end.direction))
          .normalized();
  now_.direction = {u.x(), u.y(), u.z()};
  for (std::size_t i = 0; i < 3; ++i) {
    now_.tilt[i] = std::lerp(from_.tilt[i], end.tilt[i], share_);
    now_.tilt_by_height_per_m[i] =
        std::lerp(from_.tilt_by_height_per_m[i], end.tilt_by_height_per_m[i], share_);
  }
  now_.touch_offset_m = knot_[0].penetration_m;
  now_.samples = static_cast<std::int32_t>(knots_);
  const double c = lean(now_);
  const auto between = [&](const std::array<double, 2>& ends) {
    return (1.0 - share_) * ends[0] + share_ * ends[1];
  };
  for (std::size_t k = 0; k < knots_; ++k) {
    now_.depth_m[k] = c * (knot_[k].penetration_m - knot_[0].penetration_m);
    now_.force_n[k] = between(knot_[k].force_n) / c;
    now_.stiffness_n_per_m[k] = between(knot_[k].stiffness_n_per_m) / (c * c);
  }
  now_.force_n[0] = 0.0;
  now_.energy_j[0] = 0.0;
  for (std::size_t k = 0; k + 1 < knots_; ++k) {
    const double secant = (now_.force_n[k + 1] - now_.force_n[k]) /
                          (now_.depth_m[k + 1] - now_.depth_m[k]);
    now_.stiffness_n_per_m[k] = monotone_slope(now_.stiffness_n_per_m[k], secant);
    now_.stiffness_n_per_m[k + 1] =
        monotone_slope(now_.stiffness_n_per_m[k + 1], secant);
  }
  for (std::size_t k = 0; k + 1 < knots_; ++k) {
    // The Hermite cubic's own integral: E' = f to rounding.
    const double h = now_.depth_m[k + 1] - now_.depth_m[k];
    now_.energy_j[k + 1] =
        now_.energy_j[k] + h * (now_.force_n[k] + now_.force_n[k + 1]) / 2.0 +
        h * h * (now_.stiffness_n_per_m[k] - now_.stiffness_n_per_m[k + 1]) / 12.0;
  }
}

}  // namespace palpate
