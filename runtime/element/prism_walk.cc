#include "runtime/element/prism_walk.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include <Eigen/Geometry>

#include "runtime/element/triangle.h"

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

void enter_element(FieldPlace& place, const ElementCache& cache, int slot) {
  const Element& element = element_of(cache, slot);
  place.slot = slot;
  place.prism = make_prism(element);
  if (place.kind == FieldKind::kSmooth) {
    place.smooth = make_smooth_triangle(element);
  }
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
  enter_element(place, cache, slot);
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
  // p is where the triangle was entered. On edge j k the point nearest to p is v_j + t
  // (v_k - v_j), t = (p - v_j) . e / |e|^2 held in [0, 1].
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

void take_point(FieldPlace& place, const SmoothPoint& point, const Vector3& x) {
  place.position_m = x;
  place.weight = point.weight;
  place.turn = point.turn;
  place.height_m = point.height_m;
  place.rise = point.rise;
  const Real length = point.rise.norm();
  place.normal = length > kNoNormal ? Vector3(point.rise / length) : place.normal;
}

// What an element says of a place: that it is over it, which is taken, or beyond which
// corner's edge it is.
struct Tried {
  bool inside = false;
  int beyond = -1;                 // corner opposite the edge; -1: no coordinates
  Vector3 area = Vector3::Zero();  // about where
};

Tried try_facet(FieldPlace& place, const Vector3& x) {
  PrismPoint at = place.at;
  PrismFrame frame;
  const bool found = find_coordinates(place.prism, x, Beyond::kAnalytic, at, frame) ==
                     PrismSolve::kFound;
  Tried tried{.area = at.area};
  int corner = 0;
  if (!(at.area.minCoeff(&corner) >= -kEdgeSlack)) {
    tried.beyond = corner;
  } else if (found) {
    tried.inside = true;
    set_facet(place, at, frame);
  }
  return tried;
}

Tried try_smooth(FieldPlace& place, const Vector3& x) {
  const SmoothSides sides = sides_at(place.smooth, x);
  Tried tried;
  int corner = 0;
  if (sides.altitudes.head<3>().minCoeff(&corner) <
      -kEdgeSlack) {  // 0 where it is not sound
    const Real t = std::clamp(sides.along(corner), Real(0.0), Real(1.0));
    tried.beyond = corner;
    tried.area((corner + 1) % 3) = 1.0 - t;
    tried.area((corner + 2) % 3) = t;
    return tried;
  }
  SmoothPoint point;
  tried.inside = set_inside(place.smooth, sides, x, point);
  if (tried.inside) {
    take_point(place, point, x);
  }
  return tried;
}

Tried try_here(FieldPlace& place, const Vector3& x) {
  Tried tried =
      place.kind == FieldKind::kSmooth ? try_smooth(place, x) : try_facet(place, x);
  if (tried.inside) {
    place.folded = false;
    place.outside = false;
  }
  return tried;
}

// The nearest point of the element's plane, through neighbours while there are any.
void settle_nearest(FieldPlace& place, const ElementCache& cache, const Vector3& x) {
  // 1. Through neighbours to the triangle in whose plane the nearest point of x is
  // inside. The walk ends at a border, a missing neighbour, or where it would turn
  // back.
  int from = -1;
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
  // 2. The smooth field may have coordinates in that triangle.
  if (place.kind == FieldKind::kSmooth && !place.prism.flat &&
      try_here(place, x).inside) {
    place.starved = false;
    return;
  }
  // 3. No sound coordinates: the nearest point's weights are held, s = (x - sum w_j
  // v_j) . n, and n is the blended normal there.
  place.folded = true;
  place.outside = false;
  PrismFrame frame;
  frame.weight = place.at.area;
  const Vector3 sum = place.prism.normal * frame.weight;
  const Real length = sum.norm();
  frame.normal = length > kNoNormal ? Vector3(sum / length) : place.normal;
  frame.position_m = x;
  place.at.height_m = (x - place.prism.corner_m * frame.weight).dot(frame.normal);
  set_facet(place, place.at, frame);
  place.turn.setZero();
}

bool follow_facet_within(FieldPlace& place, const Vector3& x) {
  PrismPoint at = place.at;
  PrismFrame frame;
  if (place.prism.flat || find_coordinates(place.prism, x, Beyond::kHeld, at, frame) !=
                              PrismSolve::kFound) {
    return false;
  }
  set_facet(place, at, frame);
  place.outside = at.area.minCoeff() < -kEdgeSlack;
  return true;
}

bool follow_smooth_within(FieldPlace& place, const Vector3& x) {
  const SmoothSides sides = sides_at(place.smooth, x);
  const bool outside = sides.altitudes.head<3>().minCoeff() < -kEdgeSlack;
  SmoothPoint point;
  if (place.prism.flat || !(outside ? set_beyond(place.smooth, sides, x, point)
                                    : set_inside(place.smooth, sides, x, point))) {
    return false;
  }
  take_point(place, point, x);
  place.outside = outside;
  return true;
}

}  // namespace

void set_facet(FieldPlace& place, const PrismPoint& at,
               const PrismFrame& frame) noexcept {
  place.at = at;
  place.frame = frame;
  place.position_m = frame.position_m;
  place.weight = frame.weight;
  place.turn.leftCols<2>() = frame.turn;
  place.height_m = at.height_m;
  place.normal = frame.normal;
  place.rise = frame.normal;
}

Vector3 gradient(const FieldPlace& place, const Vector3& slope,
                 Real by_height_per_m) noexcept {
  return place.kind == FieldKind::kSmooth
             ? Vector3(slope + by_height_per_m * place.rise)
             : gradient(place.frame, slope(0), slope(1), by_height_per_m);
}

Vector3 foot_m(const FieldPlace& place) noexcept {
  const Prism& prism = place.prism;
  if (place.kind == FieldKind::kFacets) {
    return prism.corner_m * place.weight;
  }
  Vector3 foot = place.position_m;
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Vector3 n = prism.normal.col(j);
    foot -= (place.weight(j) * n.dot(place.position_m - prism.corner_m.col(j))) * n;
  }
  return foot;
}

Matrix3 foot_turn(const FieldPlace& place) noexcept {
  const Prism& prism = place.prism;
  if (place.kind == FieldKind::kFacets) {
    return prism.corner_m * place.turn;
  }
  Matrix3 turn = Matrix3::Identity();
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Vector3 n = prism.normal.col(j);
    const Real height_m = n.dot(place.position_m - prism.corner_m.col(j));
    turn -= n * (height_m * place.turn.row(j) + place.weight(j) * n.transpose());
  }
  return turn;
}

bool follow_within(FieldPlace& place, const Vector3& x_m) noexcept {
  const bool found = place.kind == FieldKind::kSmooth ? follow_smooth_within(place, x_m)
                                                      : follow_facet_within(place, x_m);
  place.folded = place.folded && !found;
  return found;
}

void follow(FieldPlace& place, const ElementCache& cache, const Vector3& x_m) noexcept {
  int from = -1;
  place.starved = false;
  // Newton's method on facets begins at the second-order estimate, where the last place
  // has one.
  if (place.kind == FieldKind::kFacets && !place.folded && !place.outside &&
      place.frame.scale > kScaleMin) {
    predict(place.frame, x_m - place.frame.position_m, place.prism.size_m, place.at);
  }
  for (int crossed = 0; crossed < kWalkMax; ++crossed) {
    const int here = place.slot;
    // A triangle without area has no coordinates: over it to the next.
    if (place.prism.flat) {
      if (!leave_flat(place, cache, from, x_m)) {
        break;
      }
      from = here;
      continue;
    }
    const Tried tried = try_here(place, x_m);
    if (tried.inside) {
      return;
    }
    // No coordinates: the nearest point is taken below.
    if (tried.beyond < 0) {
      break;
    }
    const Crossing over = across(cache, element_of(cache, here), tried.beyond);
    // No way on, or back over the edge just crossed: the element's functions go on
    // beyond its edge.
    if (over.slot < 0 || over.slot == from || !tried.area.allFinite()) {
      if (!follow_within(place, x_m)) {
        break;
      }
      place.starved = place.outside && over.slot < 0 && !over.border;
      return;
    }
    from = here;
    cross_into(place, cache, over.slot, inside(tried.area), x_m);
  }
  settle_nearest(place, cache, x_m);
}

void adopt(FieldPlace& place, const ElementCache& cache, int slot, const Vector3& x_m,
           FieldKind kind) noexcept {
  place = {};
  place.kind = kind;
  enter_element(place, cache, slot);
  const Matrix3& v = place.prism.corner_m;
  place.at.area = triangle::nearest_inside(v, triangle::area_coordinates(v, x_m));
  const Vector3 sum = place.prism.normal * place.at.area;
  const Real length = sum.norm();
  place.at.height_m =
      length > kNoNormal ? (x_m - v * place.at.area).dot(sum) / length : 0.0;
  follow(place, cache, x_m);
}

void move_to_copy(FieldPlace& place, const ElementCache& cache, int slot) noexcept {
  enter_element(place, cache, slot);
  if (place.kind == FieldKind::kSmooth && !place.folded) {
    (void)follow_within(place, place.position_m);
  }
}

}  // namespace palpate
