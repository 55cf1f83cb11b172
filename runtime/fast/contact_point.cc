#include "runtime/fast/contact_point.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>

#include "runtime/fast/triangle.h"

namespace palpate {
namespace {

// Elements that one tick may cross.
constexpr int kWalkMax = 4;
// Area coordinates this far below zero still count as inside.
constexpr double kEdgeSlack = 1e-9;
// Cosine of u and the face normal below which u no longer serves to project.
constexpr double kGrazing = 0.1;
// Longest Newton step, in edges of the element.
constexpr double kStepMax = 4.0;

const Element& element_of(const ElementCache& cache, int slot) {
  return cache.element[static_cast<std::size_t>(slot)];
}

using Triple = std::array<double, 3>;

Eigen::Vector3d vector(const Triple& values) {
  return Eigen::Map<const Eigen::Vector3d>(values.data());
}

Eigen::Matrix3d corners(const Element& element) {
  Eigen::Matrix3d v;
  v << vector(element.node[0].position_m), vector(element.node[1].position_m),
      vector(element.node[2].position_m);
  return v;
}

// sum of n_j times a vector of node j.
Eigen::Vector3d blend(const Element& element, Triple ElementNode::*field,
                      const Eigen::Vector3d& area) {
  return area(0) * vector(element.node[0].*field) +
         area(1) * vector(element.node[1].*field) +
         area(2) * vector(element.node[2].*field);
}

Eigen::Vector3d unit_or_zero(const Eigen::Vector3d& v) {
  const double length = v.norm();
  return length > 1e-12 ? Eigen::Vector3d(v / length) : Eigen::Vector3d::Zero();
}

// Solves [a b -c] (p, q, s) = r by Cramer's rule. False where the columns are nearly
// dependent, measured against the face's own area.
bool solve_columns(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                   const Eigen::Vector3d& c, const Eigen::Vector3d& r, double face,
                   Eigen::Vector2d& step) {
  const Eigen::Vector3d ab = a.cross(b);
  const double det = ab.dot(c);
  if (!(det > kGrazing * face)) {
    return false;
  }
  step = {r.cross(b).dot(c) / det, a.cross(r).dot(c) / det};
  return step.cwiseAbs().maxCoeff() <= kStepMax;
}

// Area coordinates of the anchor for which delta_t = tau.
Eigen::Vector3d solve_anchor(const ElementModel& model, const Element& element,
                             const Eigen::Vector3d& x, const Eigen::Vector3d& tau,
                             double radius) {
  const auto edge = [&](Triple ElementNode::*field, std::size_t j) {
    return Eigen::Vector3d(vector(element.node[j].*field) -
                           vector(element.node[0].*field));
  };
  const Eigen::Vector3d e1 = edge(&ElementNode::position_m, 1);
  const Eigen::Vector3d e2 = edge(&ElementNode::position_m, 2);
  if (triangle::flat(e1, e2)) {
    return {1.0, 0.0, 0.0};
  }
  const double doubled_area = e1.cross(e2).norm();
  const Eigen::Vector3d& u = model.direction;
  const double d = (model.rest_m - x).dot(u);
  const Eigen::Vector3d r = (x - tau) - (model.rest_m - d * u);
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  bool solved = false;
  if (!model.outside && std::abs(d) <= 2.0 * radius + std::sqrt(doubled_area)) {
    const auto column = [&](const Eigen::Vector3d& e, std::size_t j) {
      return Eigen::Vector3d(e + radius * edge(&ElementNode::normal, j) -
                             d * edge(&ElementNode::direction, j));
    };
    solved = solve_columns(column(e1, 1), column(e2, 2), u, r, doubled_area, step);
  }
  if (!solved) {
    solved = solve_columns(e1, e2, u, r, doubled_area, step);
  }
  if (solved) {
    return model.anchor_area + Eigen::Vector3d(-step.sum(), step(0), step(1));
  }
  return triangle::area_coordinates(corners(element), x - radius * model.normal - tau);
}

// An element of the cache into which the anchor projects, near its plane and facing
// the same way; -1 if there is none.
int slot_containing(const ElementCache& cache, const ElementModel& model) {
  for (int slot = 0; slot < kCacheSlots; ++slot) {
    if (slot == model.slot || cache.stored_at[static_cast<std::size_t>(slot)] == 0) {
      continue;
    }
    const Element& element = element_of(cache, slot);
    const Eigen::Matrix3d v = corners(element);
    const Eigen::Vector3d area = triangle::area_coordinates(v, model.anchor_m);
    const Eigen::Vector3d face = (v.col(1) - v.col(0)).cross(v.col(2) - v.col(0));
    const Eigen::Vector3d off = v * area - model.anchor_m;
    const bool near = off.squaredNorm() <= 0.25 * face.norm();
    if (area.minCoeff() >= 0.0 && near && face.dot(model.normal) > 0.0) {
      return slot;
    }
  }
  return -1;
}

// The element across the edge that the anchor has crossed farthest; -1 if the cache
// does not hold it. `border`: there is none.
int next_slot(const ElementCache& cache, const Element& element,
              const Eigen::Vector3d& area, bool& border) {
  int corner = 0;
  area.minCoeff(&corner);
  const std::int32_t across =
      element.neighbour[static_cast<std::size_t>((corner + 1) % 3)];
  border = across < 0;
  return border ? -1 : find(cache, across);
}

}  // namespace

void place(ElementModel& model, const ElementCache& cache, int slot,
           const Eigen::Vector3d& area, double tool_radius_m) noexcept {
  const Element& element = element_of(cache, slot);
  const Eigen::Matrix3d v = corners(element);
  model.slot = slot;
  model.outside = area.minCoeff() < -kEdgeSlack;
  model.area = triangle::nearest_inside(v, area);
  model.anchor_area = model.outside ? area : model.area;
  model.anchor_m = blend(element, &ElementNode::position_m, model.anchor_area);
  model.normal = unit_or_zero(blend(element, &ElementNode::normal, model.area));
  model.direction = unit_or_zero(blend(element, &ElementNode::direction, model.area));
  model.rest_m = model.anchor_m + tool_radius_m * model.normal;
  model.friction = 0.0;
  model.presliding_m = 0.0;
  for (int j = 0; j < 3; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const ElementNode& node = element.node[i];
    const Eigen::Map<const Eigen::Vector3d> n(node.normal.data());
    const Eigen::Map<const Eigen::Vector3d> u(node.direction.data());
    model.touch_m[i] = node.touch_offset_m * std::abs(n.dot(u));
    model.friction += model.area(j) * node.friction;
    model.presliding_m += model.area(j) * node.presliding_m;
  }
}

void adopt(ElementModel& model, const ElementCache& cache, int slot,
           const Eigen::Vector3d& x_m, double tool_radius_m) noexcept {
  const Eigen::Matrix3d v = corners(element_of(cache, slot));
  const Eigen::Vector3d area = triangle::area_coordinates(v, x_m);
  place(model, cache, slot, triangle::nearest_inside(v, area), tool_radius_m);
  follow(model, cache, x_m, Eigen::Vector3d::Zero(), tool_radius_m);
  follow(model, cache, x_m, Eigen::Vector3d::Zero(), tool_radius_m);
}

void follow(ElementModel& model, const ElementCache& cache, const Eigen::Vector3d& x_m,
            const Eigen::Vector3d& tau_m, double tool_radius_m) noexcept {
  model.starved = false;
  for (int crossed = 0;; ++crossed) {
    const Element& element = element_of(cache, model.slot);
    const Eigen::Vector3d area =
        solve_anchor(model, element, x_m, tau_m, tool_radius_m);
    const bool inside = area.minCoeff() >= -kEdgeSlack;
    place(model, cache, model.slot, area, tool_radius_m);
    if (inside || crossed == kWalkMax) {
      return;
    }
    bool border = false;
    int next = next_slot(cache, element, area, border);
    if (next < 0) {
      next = slot_containing(cache, model);
    }
    if (next < 0) {
      model.starved = !border;
      return;
    }
    const Eigen::Matrix3d v = corners(element_of(cache, next));
    place(model, cache, next,
          triangle::nearest_inside(v, triangle::area_coordinates(v, model.anchor_m)),
          tool_radius_m);
  }
}

}  // namespace palpate
