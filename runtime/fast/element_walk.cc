#include "runtime/fast/element_walk.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>

#include "runtime/element/triangle.h"

namespace palpate {
namespace {

// Elements that the anchor may cross in one tick.
constexpr int kAnchorWalkMax = 4;
// Area coordinates of the anchor this far below zero still count as inside.
constexpr Real kAnchorSlack = rounding(1e-9, 1e-6);
// Cosine of u and the face normal below which u no longer serves to project.
constexpr Real kGrazing = 0.1;
// Longest Newton step, in edges of the element.
constexpr Real kStepMax = 4.0;

using Triple = std::array<Real, 3>;

Vector3 vector(const Triple& values) {
  return Eigen::Map<const Vector3>(values.data());
}

Matrix3 corners(const Element& element) {
  Matrix3 v;
  v << vector(element.node[0].position_m), vector(element.node[1].position_m),
      vector(element.node[2].position_m);
  return v;
}

Vector3 unit_or_zero(const Vector3& v) {
  const Real length = v.norm();
  return length > 1e-12 ? Vector3(v / length) : Vector3::Zero();
}

// Solves [a b -c] (p, q, s) = r for p and q by Cramer's rule. False where the columns
// are nearly dependent, measured against the face's own area.
bool solve_columns(const Vector3& a, const Vector3& b, const Vector3& c,
                   const Vector3& r, Real face, Vector2& step) {
  const Real det = a.cross(b).dot(c);
  if (!(det > kGrazing * face)) {
    return false;
  }
  const Vector3 cr = c.cross(r);
  step = {b.dot(cr) / det, -a.dot(cr) / det};
  return step.cwiseAbs().maxCoeff() <= kStepMax;
}

// Area coordinates of the anchor for which delta_t = tau.
Vector3 solve_anchor(const ElementModel& model, const Vector3& x, const Vector3& tau,
                     Real radius) {
  const Prism& prism = model.prism;
  if (prism.flat) {
    return {1.0, 0.0, 0.0};
  }
  // One Newton step for the anchor's n_1, n_2 and the depth d = (rest - x) . u of
  //   x - tau = rest(n) - d u(n),   rest(n) = sum n_j v_j + R n_out(n),
  // with r what is missing. Column j is v_j - v_0 + R (n_j - n_0) - d (u_j - u_0), the
  // blended vectors not normalised; the third is -u.
  const auto edge = [](const Matrix3& field, Eigen::Index j) {
    return Vector3(field.col(j) - field.col(0));
  };
  const Vector3 e1 = edge(prism.corner_m, 1);
  const Vector3 e2 = edge(prism.corner_m, 2);
  const Vector3& u = model.direction;
  const Real d = (model.rest_m - x).dot(u);
  const Vector3 r = (x - tau) - (model.rest_m - d * u);
  Vector2 step = Vector2::Zero();
  bool solved = false;
  if (!model.outside && std::abs(d) <= 2.0 * radius + prism.size_m) {
    const auto column = [&](const Vector3& e, Eigen::Index j) {
      return Vector3(e + radius * edge(prism.normal, j) - d * edge(model.toward, j));
    };
    solved =
        solve_columns(column(e1, 1), column(e2, 2), u, r, prism.doubled_area_m2, step);
  }
  // Beyond the element, far away, or with columns nearly dependent: normals and
  // directions do not turn.
  if (!solved) {
    solved = solve_columns(e1, e2, u, r, prism.doubled_area_m2, step);
  }
  if (solved) {
    return model.anchor_area + Vector3(-step.sum(), step(0), step(1));
  }
  // Where u grazes the face, or the step is too long: x - R n_out - tau, projected onto
  // the plane.
  return triangle::area_coordinates(prism.corner_m, x - radius * model.normal - tau);
}

// An element of the cache into which the anchor projects, near its plane and facing
// the same way; -1 if there is none.
int slot_containing(const ElementCache& cache, const ElementModel& model) {
  for (int slot = 0; slot < kCacheSlots; ++slot) {
    if (slot == model.slot || cache.stored_at[static_cast<std::size_t>(slot)] == 0) {
      continue;
    }
    const Element& element = element_of(cache, slot);
    const Matrix3 v = corners(element);
    const Vector3 area = triangle::area_coordinates(v, model.anchor_m);
    const Vector3 face = (v.col(1) - v.col(0)).cross(v.col(2) - v.col(0));
    const Vector3 off = v * area - model.anchor_m;
    const bool near = off.squaredNorm() <= 0.25 * face.norm();
    if (area.minCoeff() >= 0.0 && near && face.dot(model.normal) > 0.0) {
      return slot;
    }
  }
  return -1;
}

// What of an element does not depend on the contact point.
void take_element(ElementModel& model, const Element& element, int slot) {
  model.slot = slot;
  model.prism = make_prism(element);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const ElementNode& node = element.node[j];
    model.toward.col(column) = vector(node.direction);
    model.touch_m[j] =
        node.touch_offset_m *
        std::abs(model.prism.normal.col(column).dot(model.toward.col(column)));
  }
}

// The element across the edge that the anchor has crossed farthest; -1 if the cache
// does not hold it. `border`: there is none.
int next_slot(const ElementCache& cache, const Element& element, const Vector3& area,
              bool& border) {
  int corner = 0;
  area.minCoeff(&corner);
  const std::int32_t across =
      element.neighbour[static_cast<std::size_t>((corner + 1) % 3)];
  border = across < 0;
  return border ? -1 : find(cache, across);
}

}  // namespace

void place(ElementModel& model, const ElementCache& cache, int slot,
           const Vector3& area, Real tool_radius_m) noexcept {
  const Element& element = element_of(cache, slot);
  if (model.slot != slot) {
    take_element(model, element, slot);
  }
  const Prism& prism = model.prism;
  model.outside = area.minCoeff() < -kAnchorSlack;
  model.area = triangle::nearest_inside(prism.corner_m, area);
  model.anchor_area = model.outside ? area : model.area;
  model.anchor_m = prism.corner_m * model.anchor_area;
  model.normal = unit_or_zero(prism.normal * model.area);
  model.direction = unit_or_zero(model.toward * model.area);
  model.rest_m = model.anchor_m + tool_radius_m * model.normal;
  model.friction = 0.0;
  model.presliding_m = 0.0;
  for (std::size_t j = 0; j < 3; ++j) {
    const Real weight = model.area(static_cast<Eigen::Index>(j));
    model.friction += weight * element.node[j].friction;
    model.presliding_m += weight * element.node[j].presliding_m;
  }
}

void adopt(ElementModel& model, const ElementCache& cache, int slot, const Vector3& x_m,
           Real tool_radius_m) noexcept {
  const Matrix3 v = corners(element_of(cache, slot));
  const Vector3 area = triangle::area_coordinates(v, x_m);
  place(model, cache, slot, triangle::nearest_inside(v, area), tool_radius_m);
  follow(model, cache, x_m, Vector3::Zero(), tool_radius_m);
  follow(model, cache, x_m, Vector3::Zero(), tool_radius_m);
}

void follow(ElementModel& model, const ElementCache& cache, const Vector3& x_m,
            const Vector3& tau_m, Real tool_radius_m) noexcept {
  model.starved = false;
  for (int crossed = 0;; ++crossed) {
    // 1. The anchor for which the presliding displacement is tau; outside its triangle
    // its plane goes on.
    const Element& element = element_of(cache, model.slot);
    const Vector3 area = solve_anchor(model, x_m, tau_m, tool_radius_m);
    const bool inside = area.minCoeff() >= -kAnchorSlack;
    place(model, cache, model.slot, area, tool_radius_m);
    if (inside || crossed == kAnchorWalkMax) {
      return;
    }
    // 2. The neighbour over the edge that is passed most; else any element at hand that
    // lies there.
    bool border = false;
    int next = next_slot(cache, element, area, border);
    if (next < 0) {
      next = slot_containing(cache, model);
    }
    if (next < 0) {
      model.starved = !border;
      return;
    }
    // 3. From the point of that element nearest to the anchor once more.
    const Matrix3 v = corners(element_of(cache, next));
    place(model, cache, next,
          triangle::nearest_inside(v, triangle::area_coordinates(v, model.anchor_m)),
          tool_radius_m);
  }
}

}  // namespace palpate
