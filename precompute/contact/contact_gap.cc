#include "precompute/contact/contact_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "formats/base/reproducible.h"

namespace palpate {
namespace {

// The near side above a point: how high along the press, and how that changes with the
// tool's position.
struct Height {
  double along_m = 0.0;
  Eigen::Vector3d by_tool;
};

// Near side of a tool that stands along the press, at a distance s from its axis.
struct Profile {
  double height_m = 0.0;  // above the reference
  double slope = 0.0;
};

// The ball's lower half, straight from where it is as steep as `steepest`.
Profile ball_profile(const Eigen::Vector2d& centre_m, double radius_m, double s) {
  const double out = s - centre_m.x();
  const double below = std::sqrt(std::max(0.0, radius_m * radius_m - out * out));
  return {centre_m.y() - below, out / below};
}

// Arcs of the ball round the outline's corners and straight pieces between them, in
// turn, until the steepest slope that counts. The last piece is steep or endless.
Profile profile_at(const ToolSurface& surface, double s) {
  const double ball = surface.ball_radius_m();
  const double cosine = surface.steepest_cosine();
  const double sine = std::sqrt(1.0 - cosine * cosine);
  Profile profile;
  for (const OutlineEdge& edge : surface.outline()) {
    const bool steep = edge.direction.x() < cosine;
    const Eigen::Vector2d along =
        steep ? Eigen::Vector2d(cosine, sine) : edge.direction;
    // The ball's arc round an edge's base ends at base + ball times the edge's outward
    // normal.
    const Eigen::Vector2d arc_end =
        edge.base_m + ball * Eigen::Vector2d(along.y(), -along.x());
    if (ball > 0.0 && s < arc_end.x()) {
      return ball_profile(edge.base_m, ball, s);
    }
    const double slope = along.y() / along.x();
    profile = {arc_end.y() + slope * (s - arc_end.x()), slope};
    if (steep || s <= arc_end.x() + edge.length_m * edge.direction.x()) {
      break;
    }
  }
  return profile;
}

bool stands_along_press(const PlacedTool& tool) {
  return tool.surface->turns_about_axis() &&
         tool.rotation.col(2).dot(tool.press) > 1.0 - 1e-15;
}

Height height_by_profile(const Eigen::Vector3d& p_m, const PlacedTool& tool) {
  // t = profile(s) - b with r = p - reference, b = press . r, s = |r - b press|.
  // dt/d(reference) = press - profile'(s) (r - b press) / s.
  const Eigen::Vector3d r = p_m - tool.reference_m;
  const double b = tool.press.dot(r);
  const Eigen::Vector3d across = r - b * tool.press;
  const double s = across.norm();
  const Profile profile = profile_at(*tool.surface, s);
  const Eigen::Vector3d uphill =
      s > 0.0 ? Eigen::Vector3d(profile.slope / s * across) : Eigen::Vector3d::Zero();
  return {profile.height_m - b, tool.press - uphill};
}

// The distance to the tool along the line p + t press: convex in t.
class Line {
 public:
  Line(const Eigen::Vector3d& p_m, const PlacedTool& tool) : p_m_(p_m), tool_(tool) {}

  struct Point {
    double t_m;
    ToolDistance to_tool;
    double rate;  // d(distance)/dt
  };
  [[nodiscard]] Point at(double t_m) const {
    const ToolDistance d = distance(tool_, p_m_ + t_m * tool_.press);
    return {t_m, d, d.normal.dot(tool_.press)};
  }

 private:
  Eigen::Vector3d p_m_;
  const PlacedTool& tool_;
};

// Where the rate reaches -cosine between two points: there t + distance / cosine is
// least. Newton's method, bisection where it leaves the bracket.
Line::Point least_between(const Line& line, Line::Point below, Line::Point above,
                          double cosine, const Eigen::Vector3d& press) {
  Line::Point here = below;
  for (int i = 0; i < 60 && std::abs(here.rate + cosine) > 1e-12; ++i) {
    const double bend = press.dot(here.to_tool.curvature_per_m * press);
    double t = here.t_m - (here.rate + cosine) / bend;
    if (!(t > below.t_m && t < above.t_m)) {
      t = 0.5 * (below.t_m + above.t_m);
    }
    here = line.at(t);
    (here.rate <= -cosine ? below : above) = here;
  }
  return here;
}

// A point of the line so far below that the tool is as good as straight above it.
Line::Point far_below(const Line& line, double t_m, double step_m, double cosine) {
  Line::Point here = line.at(t_m - step_m);
  for (int i = 0; i < 60 && here.rate > -0.5 * (1.0 + cosine); ++i) {
    step_m *= 2.0;
    here = line.at(t_m - step_m);
  }
  return here;
}

Height height_on_line(const Eigen::Vector3d& p_m, const PlacedTool& tool) {
  // Newton's method for D(t) = D(p + t press) = 0. D is convex along the line, and a
  // tangent of a convex function lies below the function. Steps from below therefore
  // never pass the lower root.
  const double cosine = tool.surface->steepest_cosine();
  const Line line(p_m, tool);
  // At t = lowest - b the point is level with the tool's lowest point. `scale` [m]
  // bounds the lengths that take part.
  const Eigen::Vector3d r = p_m - tool.reference_m;
  const double b = tool.press.dot(r);
  const double lowest =
      -tool.surface->support_m(-(tool.rotation.transpose() * tool.press));
  const double scale = (r - b * tool.press).norm() + std::abs(lowest) +
                       tool.surface->extent_m() + std::abs(b);
  Line::Point here = far_below(line, lowest - b, scale, cosine);
  for (int i = 0; i < 100; ++i) {
    const double step = here.to_tool.distance_m / -here.rate;
    if (!(step > 1e-14 * scale)) {
      break;
    }
    const Line::Point next = line.at(here.t_m + step);
    // The flank is steeper than counts before the root: the least of tau + D / c
    // replaces the root. The place of the least lies between the last two points.
    if (next.rate > -cosine) {
      here = least_between(line, here, next, cosine, tool.press);
      return {here.t_m + here.to_tool.distance_m / cosine,
              here.to_tool.normal / here.rate};
    }
    here = next;
  }
  return {here.t_m + here.to_tool.distance_m / -here.rate,
          here.to_tool.normal / here.rate};
}

}  // namespace

Gap tool_gap(const Eigen::Vector3d& p_m, const Eigen::Vector3d& normal,
             const PlacedTool& tool) {
  const double facing = std::max(0.0, tool.press.dot(normal));
  if (facing == 0.0) {
    return {0.0, Eigen::Vector3d::Zero()};
  }
  const Height height = stands_along_press(tool) ? height_by_profile(p_m, tool)
                                                 : height_on_line(p_m, tool);
  const Gap gap{facing * height.along_m, facing * height.by_tool};
  if (facing < 1.0 && gap.distance_m > 0.0 && distance_m(tool, p_m) > gap.distance_m) {
    const ToolDistance straight = distance(tool, p_m);
    return {straight.distance_m, -straight.normal};
  }
  return gap;
}

Gap average_gap(const ContactNode& node, const PlacedTool& tool) {
  Gap average{0.0, Eigen::Vector3d::Zero()};
  for (const GapPoint& point : node.gap_points) {
    const Gap gap = tool_gap(point.position_m, point.normal, tool);
    average.distance_m += point.weight * gap.distance_m;
    average.by_tool += point.weight * gap.by_tool;
  }
  return average;
}

double shadow_radius_m(const PlacedTool& tool, double height_m) {
  if (!tool.reference_m.allFinite()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const ToolSurface& surface = *tool.surface;
  const bool upright = stands_along_press(tool);
  if (upright && surface.outline().front().direction.x() == 0.0) {
    // A ball's end: the parabola that it is to first order.
    const double R = surface.ball_radius_m();
    return std::min(R, std::sqrt(2.0 * R * height_m));
  }
  const Eigen::Vector3d lowest_at =
      tool.reference_m -
      surface.support_m(-(tool.rotation.transpose() * tool.press)) * tool.press;
  const Eigen::Vector3d side = tool.press.unitOrthogonal();
  const Eigen::Vector3d other = tool.press.cross(side);
  const auto above = [&](const Eigen::Vector3d& p) {
    return tool_gap(p, tool.press, tool).distance_m;
  };
  const double limit = std::max(height_m, above(lowest_at)) * (1.0 + 1e-9);
  constexpr int kRays = 96;
  // Every ray begins at the widest distance so far, so that only a wider ray adds to
  // it. The step doubles while the near side stays low. A quarter of the step is tried
  // where it does not.
  double widest = 0.0;
  for (int k = 0; k < (upright ? 1 : kRays); ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kRays;
    const Eigen::Vector3d ray =
        reproducible::cos(angle) * side + reproducible::sin(angle) * other;
    double step = std::max(widest, height_m);
    while (step > 1e-3 * std::max(widest, height_m)) {
      const bool low = above(lowest_at + (widest + step) * ray) <= limit;
      widest += low ? step : 0.0;
      step *= low ? 2.0 : 0.25;
    }
  }
  return widest;
}

}  // namespace palpate
