#include "tests/peers/hand_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_search.h"

namespace palpate::peers {
namespace {

constexpr double kAboveM = 0.002;  // where hands begin and end
constexpr double kApproachMPerS = 0.02;
constexpr double kSlideShare = 0.6;   // of the largest depth
constexpr double kCycleM = 0.008;     // way to the side
constexpr double kCycleMPerS = 0.01;  // slow: the work is a sum over ticks
constexpr double kTickS = 0.001;
constexpr int kSlowestMmPerS = 20;
constexpr double kPi = std::numbers::pi;

// A hand that is drawn tick by tick.
class Pen {
 public:
  Pen(const SurfaceFrame& frame, std::string name)
      : frame_(frame), hand_{.name = std::move(name), .tick = {}, .truth_tick = {}} {}

  void put(double u, double v, double depth) {
    hand_.tick.push_back(frame_.place(u, v, depth));
    last_ = {u, v, depth};
  }

  // Straight from where it is, at a constant speed; the end exactly.
  void go(double u, double v, double depth, double m_per_s) {
    const Eigen::Vector3d from = last_;
    const Eigen::Vector3d way = Eigen::Vector3d(u, v, depth) - from;
    const int ticks =
        std::max(1, static_cast<int>(std::lround(way.norm() / m_per_s / kTickS)));
    for (int i = 1; i <= ticks; ++i) {
      const Eigen::Vector3d at = from + way * i / ticks;
      put(at.x(), at.y(), at.z());
    }
  }

  void truth_here() { hand_.truth_tick.push_back(hand_.tick.size() - 1); }

  // At so many ticks of those from `begin` on, evenly.
  void truth_evenly(std::size_t begin, int points) {
    const std::size_t ticks = hand_.tick.size() - begin;
    for (int i = 0; i < points; ++i) {
      hand_.truth_tick.push_back(begin + ticks * static_cast<std::size_t>(i) /
                                             static_cast<std::size_t>(points));
    }
  }

  // From `begin` to where it is, kDenseTicks apart.
  void dense_truth(std::size_t begin) {
    for (std::size_t tick = begin; tick < hand_.tick.size(); tick += kDenseTicks) {
      hand_.dense_tick.push_back(tick);
    }
  }

  [[nodiscard]] std::size_t ticks() const { return hand_.tick.size(); }
  PlannedHand done() { return std::move(hand_); }

 private:
  const SurfaceFrame& frame_;
  PlannedHand hand_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
};

PlannedHand press(const SurfaceFrame& frame, const HandRecipe& r) {
  Pen pen(frame, "press");
  for (const double u : {0.0, 0.6 * r.half_slide_m, -0.6 * r.half_slide_m}) {
    const std::size_t begin = pen.ticks();
    for (int i = 0; i <= 1000; ++i) {
      const double s = std::sin(kPi * i * kTickS);
      pen.put(u, 0.0, -kAboveM + (r.depth_max_m + kAboveM) * s * s);
    }
    pen.truth_evenly(begin, 25);
  }
  return pen.done();
}

PlannedHand slide(const SurfaceFrame& frame, const HandRecipe& r, int mm_per_s) {
  Pen pen(frame, fmt::format("slide-{}", mm_per_s));
  const double depth = kSlideShare * r.depth_max_m;
  pen.put(-r.half_slide_m, 0.0, -kAboveM);
  pen.truth_here();
  pen.go(-r.half_slide_m, 0.0, depth, kApproachMPerS);
  const std::size_t begin = pen.ticks() - 1;
  for (int i = 1; i <= r.slide_points; ++i) {
    pen.go(r.half_slide_m * (2.0 * i / r.slide_points - 1.0), 0.0, depth,
           1e-3 * mm_per_s);
    pen.truth_here();
  }
  if (mm_per_s == kSlowestMmPerS && r.dense_truth) {
    pen.dense_truth(begin);
  }
  pen.go(r.half_slide_m, 0.0, -kAboveM, kApproachMPerS);
  pen.truth_here();
  return pen.done();
}

PlannedHand circle(const SurfaceFrame& frame, const HandRecipe& r) {
  Pen pen(frame, "circle");
  const double depth = kSlideShare * r.depth_max_m;
  pen.put(r.circle_m.x() + r.circle_radius_m, r.circle_m.y(), -kAboveM);
  pen.go(r.circle_m.x() + r.circle_radius_m, r.circle_m.y(), depth, kApproachMPerS);
  const std::size_t begin = pen.ticks();
  for (int i = 1; i <= 2000; ++i) {
    const double angle = 2.0 * kPi * i / 2000;
    pen.put(r.circle_m.x() + r.circle_radius_m * std::cos(angle),
            r.circle_m.y() + r.circle_radius_m * std::sin(angle), depth);
  }
  pen.truth_evenly(begin, r.circle_points);
  pen.go(r.circle_m.x() + r.circle_radius_m, r.circle_m.y(), -kAboveM, kApproachMPerS);
  return pen.done();
}

PlannedHand poke(const SurfaceFrame& frame, const HandRecipe& r) {
  Pen pen(frame, "poke");
  for (int i = 0; i <= 1000; ++i) {
    const double s = std::sin(3.0 * kPi * i * kTickS);
    pen.put(0.0, 0.0, -kAboveM + (r.depth_max_m + kAboveM) * s * s);
  }
  pen.truth_evenly(0, 40);
  return pen.done();
}

// Sums of sines of incommensurable frequencies: random to a renderer, the same always.
PlannedHand walk(const SurfaceFrame& frame, const HandRecipe& r) {
  Pen pen(frame, "walk");
  for (int i = 0; i <= 4000; ++i) {
    const double t = i * kTickS;
    const double u = 0.5 * std::sin(2.7 * t + 0.3) + 0.4 * std::sin(7.1 * t + 1.1);
    const double v = 0.5 * std::sin(3.9 * t + 2.0) + 0.4 * std::sin(5.3 * t + 0.4);
    const double d = 0.55 - 0.3 * std::cos(8.3 * t) - 0.25 * std::cos(14.9 * t);
    // Out of the surface in the first and the last tenth of a second.
    const double out = std::clamp(1.0 - 10.0 * std::min(t, 4.0 - t), 0.0, 1.0);
    pen.put(r.half_slide_m * u, 0.7 * r.half_slide_m * v,
            d * r.depth_max_m * (1.0 - out) - kAboveM * out);
  }
  pen.truth_evenly(100, r.walk_points);
  return pen.done();
}

PlannedHand cycle(const SurfaceFrame& frame, const HandRecipe& r, bool back) {
  Pen pen(frame, back ? "cycle-back" : "cycle");
  const double low = 0.3 * r.depth_max_m;
  const double deep = 0.9 * r.depth_max_m;
  pen.put(0.0, 0.0, -kAboveM);
  pen.go(0.0, 0.0, back ? deep : low, kCycleMPerS);
  pen.go(kCycleM, 0.0, back ? deep : low, kCycleMPerS);
  pen.go(kCycleM, 0.0, back ? low : deep, kCycleMPerS);
  pen.go(0.0, 0.0, back ? low : deep, kCycleMPerS);
  pen.go(0.0, 0.0, -kAboveM, kCycleMPerS);
  return pen.done();
}

}  // namespace

SurfaceFrame::SurfaceFrame(const SurfaceMesh& surface, const Eigen::Vector3d& near_m,
                           const Eigen::Vector3d& along)
    : surface_(surface), normal_(vertex_normals(surface)) {
  const SurfacePoint site = SurfaceSearch(surface).nearest(near_m);
  site_m_ = site.position_m;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    normal += site.area_coordinate[k] *
              normal_.row(surface.triangle(site.triangle, k)).transpose();
  }
  normal.normalize();
  const Eigen::Vector3d u = along - along.dot(normal) * normal;
  if (!(u.norm() > 1e-3 * along.norm())) {
    throw InputError("recipe: along lies along the surface's normal at the site");
  }
  axes_.row(0) = u.normalized().transpose();
  axes_.row(1) = normal.cross(u.normalized()).transpose();
  axes_.row(2) = normal.transpose();
}

PlacedDepth SurfaceFrame::place(double u_m, double v_m, double depth_m) const {
  // The highest of the triangles that the line through (u, v) meets.
  double highest = -1.0;
  PlacedDepth found{.at_m = {}, .outward = {}, .depth_m = depth_m};
  bool met = false;
  const auto local = [&](std::int32_t vertex) -> Eigen::Vector3d {
    return axes_ * (surface_.position_m.row(vertex).transpose() - site_m_);
  };
  const Eigen::Vector2d p(u_m, v_m);
  const auto twice_area = [](const auto& a, const auto& b, const auto& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  for (Eigen::Index t = 0; t < surface_.triangle.rows(); ++t) {
    const Eigen::Vector3d a = local(surface_.triangle(t, 0));
    const Eigen::Vector3d b = local(surface_.triangle(t, 1));
    const Eigen::Vector3d c = local(surface_.triangle(t, 2));
    const double area = twice_area(a, b, c);
    const Eigen::Vector3d w(twice_area(p, b, c), twice_area(p, c, a),
                            twice_area(p, a, b));
    if (!(area > 0.0) || w.minCoeff() < -1e-12 * area) {
      continue;
    }
    const Eigen::Vector3d share = w / w.sum();
    const double height = share.dot(Eigen::Vector3d(a.z(), b.z(), c.z()));
    if (met && height <= highest) {
      continue;
    }
    met = true;
    highest = height;
    const auto corner = surface_.triangle.row(t);
    found.at_m.setZero();
    found.outward.setZero();
    for (int k = 0; k < 3; ++k) {
      found.at_m += share[k] * surface_.position_m.row(corner[k]).transpose();
      found.outward += share[k] * normal_.row(corner[k]).transpose();
    }
    found.outward.normalize();
  }
  if (!met) {
    throw InputError(
        fmt::format("recipe: no surface under ({:.4g}, {:.4g}) m", u_m, v_m));
  }
  return found;
}

Eigen::Vector2d SurfaceFrame::coordinates(const Eigen::Vector3d& p_m) const {
  return (axes_ * (p_m - site_m_)).head<2>();
}

std::vector<PlannedHand> plan_hands(const SurfaceFrame& frame, const HandRecipe& r) {
  return {press(frame, r),      slide(frame, r, kSlowestMmPerS),
          slide(frame, r, 50),  slide(frame, r, 100),
          circle(frame, r),     poke(frame, r),
          walk(frame, r),       cycle(frame, r, false),
          cycle(frame, r, true)};
}

}  // namespace palpate::peers
