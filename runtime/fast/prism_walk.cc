#include "runtime/fast/prism_walk.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include <Eigen/Geometry>

#include "runtime/fast/triangle.h"

namespace palpate {
namespace {

// Elements that one tick may cross: around a vertex of high valence, and on.
constexpr int kWalkMax = 16;
// Area coordinates this far below zero still count as inside.
constexpr Real kEdgeSlack = rounding(1e-12, 1e-6);

struct Crossing {
  int slot = -1;
  bool border = false;  // there is no neighbour
};

Crossing across(const ElementCache& cache, const Element& element, int corner) {
  const std::int32_t triangle =
      element.neighbour[static_cast<std::size_t>((corner + 1) % 3)];
  return triangle < 0 ? Crossing{-1, true} : Crossing{find(cache, triangle), false};
}

bool same_node(const ElementNode& a, const ElementNode& b) {
  return a.node >= 0 || b.node >= 0 ? a.node == b.node : a.position_m == b.position_m;
}

// Into a neighbour, at the point of the shared edge that `weight` (>= 0) names.
void cross_into(FieldPlace& place, const ElementCache& cache, int slot,
                const Vector3& weight, const Vector3& x) {
  const Element& from = element_of(cache, place.slot);
  const Element& to = element_of(cache, slot);
  Vector3 area = Vector3::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (same_node(from.node[i], to.node[j])) {
        area(static_cast<Eigen::Index>(j)) = weight(static_cast<Eigen::Index>(i));
      }
    }
  }
  place.slot = slot;
  place.prism = make_prism(to);
  const Real sum = area.sum();
  const Matrix3& v = place.prism.corner_m;
  place.at.area = sum > 0.0
                      ? Vector3(area / sum)
                      : triangle::nearest_inside(v, triangle::area_coordinates(v, x));
}

Vector3 inside(const Vector3& area) {
  const Vector3 kept = area.cwiseMax(0.0);
  return kept / kept.sum();
}

// Out of a triangle without area: over the other edge that is nearest to where it was
// entered. False if the cache holds no way on.
bool leave_flat(FieldPlace& place, const ElementCache& cache, int from,
                const Vector3& x) {
  const Element& element = element_of(cache, place.slot);
  const Matrix3& v = place.prism.corner_m;
  const Vector3 p = v * place.at.area;
  Crossing way;
  Vector3 weight = place.at.area;
  Real nearest = std::numeric_limits<Real>::infinity();
  for (int corner = 0; corner < 3; ++corner) {
    const Crossing over = across(cache, element, corner);
    if (over.slot < 0 || over.slot == from) {
      continue;
    }
    const int j = (corner + 1) % 3;
    const int k = (corner + 2) % 3;
    const Vector3 edge = v.col(k) - v.col(j);
    const Real length2 = edge.squaredNorm();
    const Real t =
        length2 > 0.0 ? std::clamp((p - v.col(j)).dot(edge) / length2, 0.0, 1.0) : 0.0;
    const Real squared = (v.col(j) + t * edge - p).squaredNorm();
    if (squared < nearest) {
      nearest = squared;
      way = over;
      weight.setZero();
      weight(j) = 1.0 - t;
      weight(k) = t;
    }
  }
  if (way.slot >= 0) {
    cross_into(place, cache, way.slot, weight, x);
  }
  return way.slot >= 0;
}

// The nearest point of the element's plane, through neighbours while there are any.
void settle_nearest(FieldPlace& place, const ElementCache& cache, const Vector3& x) {
  int from = -1;
  place.folded = true;
  place.outside = false;
  for (int crossed = 0; crossed < kWalkMax; ++crossed) {
    const Matrix3& v = place.prism.corner_m;
    const Vector3 area = triangle::area_coordinates(v, x);
    int corner = 0;
    const bool beyond = area.minCoeff(&corner) < -kEdgeSlack;
    place.at.area = triangle::nearest_inside(v, area);
    const Crossing over =
        beyond ? across(cache, element_of(cache, place.slot), corner) : Crossing{};
    if (over.slot < 0 || over.slot == from || crossed + 1 == kWalkMax) {
      place.starved = beyond && !over.border && over.slot < 0;
      break;
    }
    from = place.slot;
    cross_into(place, cache, over.slot, inside(area), x);
  }
  PrismFrame frame;
  frame.weight = place.at.area;
  const Vector3 sum = place.prism.normal * frame.weight;
  const Real length = sum.norm();
  frame.normal = length > kNoNormal ? Vector3(sum / length) : place.frame.normal;
  frame.position_m = x;
  place.at.height_m = (x - place.prism.corner_m * frame.weight).dot(frame.normal);
  place.frame = frame;
}

}  // namespace

bool follow_within(FieldPlace& place, const Vector3& x_m) noexcept {
  PrismPoint at = place.at;
  PrismFrame frame;
  if (place.prism.flat || find_coordinates(place.prism, x_m, Beyond::kHeld, at,
                                           frame) != PrismSolve::kFound) {
    return false;
  }
  place.at = at;
  place.frame = frame;
  place.folded = false;
  place.outside = at.area.minCoeff() < -kEdgeSlack;
  return true;
}

void follow(FieldPlace& place, const ElementCache& cache, const Vector3& x_m) noexcept {
  int from = -1;
  place.starved = false;
  if (!place.folded && !place.outside && place.frame.scale > kScaleMin) {
    predict(place.frame, x_m - place.frame.position_m, place.prism.size_m, place.at);
  }
  for (int crossed = 0; crossed < kWalkMax; ++crossed) {
    const int here = place.slot;
    if (place.prism.flat) {
      if (!leave_flat(place, cache, from, x_m)) {
        break;
      }
      from = here;
      continue;
    }
    PrismPoint at = place.at;
    PrismFrame frame;
    const PrismSolve found =
        find_coordinates(place.prism, x_m, Beyond::kAnalytic, at, frame);
    int corner = 0;
    if (at.area.minCoeff(&corner) >= -kEdgeSlack) {
      if (found != PrismSolve::kFound) {
        break;
      }
      place.at = at;
      place.frame = frame;
      place.folded = false;
      place.outside = false;
      return;
    }
    const Crossing over = across(cache, element_of(cache, here), corner);
    if (over.slot < 0 || over.slot == from || !at.area.allFinite()) {
      if (!follow_within(place, x_m)) {
        break;
      }
      place.starved = place.outside && over.slot < 0 && !over.border;
      return;
    }
    from = here;
    cross_into(place, cache, over.slot, inside(at.area), x_m);
  }
  settle_nearest(place, cache, x_m);
}

void adopt(FieldPlace& place, const ElementCache& cache, int slot,
           const Vector3& x_m) noexcept {
  place = {};
  place.slot = slot;
  place.prism = make_prism(element_of(cache, slot));
  const Matrix3& v = place.prism.corner_m;
  place.at.area = triangle::nearest_inside(v, triangle::area_coordinates(v, x_m));
  const Vector3 sum = place.prism.normal * place.at.area;
  const Real length = sum.norm();
  place.at.height_m =
      length > kNoNormal ? (x_m - v * place.at.area).dot(sum) / length : 0.0;
  follow(place, cache, x_m);
}

void move_to_copy(FieldPlace& place, const ElementCache& cache, int slot) noexcept {
  place.slot = slot;
  place.prism = make_prism(element_of(cache, slot));
}

}  // namespace palpate
