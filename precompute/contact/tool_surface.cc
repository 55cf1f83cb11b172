#include "precompute/contact/tool_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "formats/base/reproducible.h"
#include "formats/mesh/convex_mesh.h"
#include "formats/response/turn_from_z.h"
#include "precompute/contact/convex_distance.h"

namespace palpate {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kSteepestCosine = 0.31224989991991992;  // of a flank with sine 0.95
// [-] Of a mesh's coordinates: heights above its planes are known no better.
constexpr double kRounding = 1e-14;

OutlineEdge edge_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double length = (to - from).norm();
  return {from, (to - from) / length, length};
}

std::vector<OutlineEdge> outline_of(const ToolShape& tool) {
  const Eigen::Vector2d up = Eigen::Vector2d::UnitY();
  if (tool.kind == "sphere") {
    return {{Eigen::Vector2d::Zero(), up, 0.0}};
  }
  if (tool.kind == "capsule") {
    return {{Eigen::Vector2d::Zero(), up, tool.length_m}};
  }
  if (tool.kind == "flat-punch") {
    // The core of radius R - e; the ball of radius e rounds its edge. The handle is
    // endless.
    const double e = tool.edge_radius_m;
    const Eigen::Vector2d rim(tool.radius_m - e, e);
    return {edge_between({0.0, e}, rim), {rim, up, kInf}};
  }
  if (tool.kind == "cone") {
    // Flank (sin a, cos a), a = half angle. A cone with a height ends in a level lid.
    const Eigen::Vector2d apex(0.0, tool.tip_radius_m);
    const Eigen::Vector2d flank(reproducible::sin(tool.half_angle_rad),
                                reproducible::cos(tool.half_angle_rad));
    if (tool.length_m == 0.0) {
      return {{apex, flank, kInf}};
    }
    const double length = tool.length_m / flank.y();
    const Eigen::Vector2d rim = apex + length * flank;
    return {{apex, flank, length}, edge_between(rim, {0.0, rim.y()})};
  }
  return {};
}

double ball_radius_of(const ToolShape& tool) {
  if (tool.kind == "flat-punch") {
    return tool.edge_radius_m;
  }
  return tool.kind == "cone" ? tool.tip_radius_m : tool.radius_m;
}

// Outward normal of an edge whose core lies to its left.
Eigen::Vector2d normal_of(const OutlineEdge& edge) {
  return {edge.direction.y(), -edge.direction.x()};
}

// Distance in the half plane: value, gradient and second derivative along the outline.
struct PlaneDistance {
  double distance_m = kInf;
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double curvature_per_m = 0.0;
};

PlaneDistance inside_distance(const std::vector<OutlineEdge>& outline,
                              const Eigen::Vector2d& q) {
  PlaneDistance nearest{-kInf, Eigen::Vector2d::UnitX(), 0.0};
  for (const OutlineEdge& edge : outline) {
    const double height = normal_of(edge).dot(q - edge.base_m);
    if (height > nearest.distance_m) {
      nearest = {height, normal_of(edge), 0.0};
    }
  }
  return nearest;
}

PlaneDistance outside_distance(const std::vector<OutlineEdge>& outline,
                               const Eigen::Vector2d& q) {
  PlaneDistance nearest;
  for (const OutlineEdge& edge : outline) {
    const Eigen::Vector2d from_base = q - edge.base_m;
    const double t = std::clamp(edge.direction.dot(from_base), 0.0, edge.length_m);
    const Eigen::Vector2d apart = from_base - t * edge.direction;
    const double distance = apart.norm();
    if (distance < nearest.distance_m) {
      const bool at_end = t == 0.0 || t == edge.length_m;
      // A level edge goes on smoothly through the axis.
      const bool level =
          from_base.x() == t * edge.direction.x() && edge.direction.y() == 0.0;
      const bool round = at_end && !level && distance > 0.0;
      nearest.distance_m = distance;
      nearest.normal = round ? Eigen::Vector2d(apart / distance) : normal_of(edge);
      nearest.curvature_per_m = round ? 1.0 / distance : 0.0;
    }
  }
  return nearest;
}

PlaneDistance plane_distance(const std::vector<OutlineEdge>& outline,
                             const Eigen::Vector2d& q) {
  const PlaneDistance plane = inside_distance(outline, q);
  return plane.distance_m < 0.0 ? plane : outside_distance(outline, q);
}

double largest_distance_from_axis(const SurfaceMesh& mesh) {
  return mesh.position_m.leftCols<2>().rowwise().norm().maxCoeff();
}

}  // namespace

ToolSurface::ToolSurface(const ToolShape& shape)
    : shape_(shape),
      is_ball_(shape.kind == "sphere"),
      steepest_cosine_(kSteepestCosine) {
  check(shape);
  outline_ = outline_of(shape);
  ball_radius_m_ = ball_radius_of(shape);
  double gentlest_flank = 1.0;
  if (shape.kind == "cone") {
    gentlest_flank = reproducible::sin(shape.half_angle_rad);
  } else if (shape.kind == "mesh") {
    set_planes();
    gentlest_flank = -plane_normal_.col(2).minCoeff();
  }
  steepest_cosine_ = std::min(steepest_cosine_, 0.5 * gentlest_flank);
}

void ToolSurface::set_planes() {
  const SurfaceMesh& mesh = shape_.mesh;
  const double size = bounding_box(mesh).diagonal().norm();
  rounding_m_ = kRounding * mesh.position_m.cwiseAbs().maxCoeff();
  slack_m_ = std::max(rounding_m_, kConvexityTolerance * size);
  plane_normal_.resize(mesh.triangle.rows(), 3);
  plane_offset_m_.resize(mesh.triangle.rows());
  for (Eigen::Index i = 0; i < mesh.triangle.rows(); ++i) {
    const TriangleCorners corner = corners_of(mesh, i);
    const Eigen::Vector3d twice_area =
        (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    // A triangle of no area is of no plane: infinitely far above every point.
    const bool flat = twice_area.norm() < 1e-14 * size * size;
    plane_normal_.row(i) =
        (flat ? Eigen::Vector3d::Zero() : twice_area.normalized()).transpose();
    plane_offset_m_[i] = flat ? kInf : plane_normal_.row(i).dot(corner[0]);
  }
}

ToolDistance ToolSurface::distance(const Eigen::Vector3d& p_m) const {
  return turns_about_axis() ? distance_to_core(p_m) : distance_to_mesh(p_m);
}

double ToolSurface::distance_m(const Eigen::Vector3d& p_m) const {
  return turns_about_axis()
             ? plane_distance(outline_, {std::hypot(p_m.x(), p_m.y()), p_m.z()})
                       .distance_m -
                   ball_radius_m_
             : distance_to_mesh(p_m).distance_m;
}

ToolDistance ToolSurface::distance_to_core(const Eigen::Vector3d& p_m) const {
  const double s = std::hypot(p_m.x(), p_m.y());
  const PlaneDistance plane = plane_distance(outline_, {s, p_m.z()});
  // The plane's gradient (n_s, n_z) turns about the axis: n = n_s out + n_z e_z. The
  // Hessian is c a a^T + n_s / s r r^T. Here a = `along` the outline, r = `round` the
  // axis, and c is the plane's curvature.
  const Eigen::Vector3d out = s > 0.0 ? Eigen::Vector3d(p_m.x() / s, p_m.y() / s, 0.0)
                                      : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d round(-out.y(), out.x(), 0.0);
  const Eigen::Vector3d along =
      plane.normal.y() * out - plane.normal.x() * Eigen::Vector3d::UnitZ();
  // Round the axis the normal turns by n_s / s; on the axis as along the outline.
  const double hoop = s > 0.0 ? plane.normal.x() / s : plane.curvature_per_m;
  return {plane.distance_m - ball_radius_m_,
          plane.normal.x() * out + plane.normal.y() * Eigen::Vector3d::UnitZ(),
          plane.curvature_per_m * along * along.transpose() +
              hoop * round * round.transpose()};
}

ToolDistance ToolSurface::distance_to_mesh(const Eigen::Vector3d& p_m) const {
  Eigen::Index highest = 0;
  const double height = (plane_normal_ * p_m - plane_offset_m_).maxCoeff(&highest);
  // So near, rounding decides where the nearest point would lie.
  if (height <= rounding_m_) {
    return {height, plane_normal_.row(highest).transpose(), Eigen::Matrix3d::Zero()};
  }
  NearestPoint nearest;
  for (Eigen::Index i = 0; i < shape_.mesh.triangle.rows(); ++i) {
    // Only a triangle that looks at the point, or is level with one that does, can be
    // the nearest.
    if (plane_normal_.row(i).dot(p_m) - plane_offset_m_[i] > -slack_m_) {
      take_nearer(nearest, p_m, corners_of(shape_.mesh, i));
    }
  }
  const double distance = nearest.distance_m;
  const bool on_face = nearest.corners == 3 || distance == 0.0;
  const Eigen::Vector3d normal =
      on_face ? nearest.face_normal : Eigen::Vector3d((p_m - nearest.at_m) / distance);
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
  if (on_face) {
    return {distance, normal, curvature};
  }
  // Round a corner the distance curves like a sphere's, along both tangents, and round
  // an edge like a cylinder's, across the edge alone.
  if (nearest.corners == 1) {
    curvature = (Eigen::Matrix3d::Identity() - normal * normal.transpose()) / distance;
  } else if (nearest.corners == 2) {
    const Eigen::Vector3d across = normal.cross(nearest.edge).normalized();
    curvature = across * across.transpose() / distance;
  }
  return {distance, normal, curvature};
}

double ToolSurface::support_m(const Eigen::Vector3d& direction) const {
  if (!turns_about_axis()) {
    return (shape_.mesh.position_m * direction).maxCoeff();
  }
  // max over the core of x . d, plus rho |d| for the ball. In the half plane the
  // direction is (|d_xy|, d_z). The maximum lies at an end of an edge.
  const Eigen::Vector2d d(std::hypot(direction.x(), direction.y()), direction.z());
  double support = -kInf;
  for (const OutlineEdge& edge : outline_) {
    support = std::max(support, edge.base_m.dot(d));
    const double rise = edge.direction.dot(d);
    // An endless edge across the direction ends there, whatever rounding says.
    if (edge.length_m > 0.0 && rise > 1e-12 * direction.norm()) {
      support = std::max(support, edge.base_m.dot(d) + edge.length_m * rise);
    }
  }
  return support + ball_radius_m_ * direction.norm();
}

double ToolSurface::extent_m() const {
  if (!turns_about_axis()) {
    return 2.0 * largest_distance_from_axis(shape_.mesh);
  }
  double widest = 0.0;
  for (const OutlineEdge& edge : outline_) {
    widest = std::max(widest, edge.base_m.x());
  }
  return 2.0 * (widest + ball_radius_m_);
}

PlacedTool place_on_path(const ToolSurface& surface, const Eigen::Vector3d& vertex_m,
                         const Eigen::Vector3d& outward, double penetration_m) {
  const ToolShape& shape = surface.shape();
  const bool any_axis = shape.kind == "sphere" || !shape.axis;
  const Eigen::Vector3d axis = any_axis ? outward : *shape.axis;
  const Eigen::Matrix3d rotation = turn_from_z(axis).toRotationMatrix();
  // Straight down exactly, so that an endless handle does not come near by rounding.
  const Eigen::Vector3d down = any_axis
                                   ? Eigen::Vector3d(-Eigen::Vector3d::UnitZ())
                                   : Eigen::Vector3d(-rotation.transpose() * outward);
  return {&surface, rotation,
          vertex_m + (surface.support_m(down) - penetration_m) * outward, outward};
}

double distance_m(const PlacedTool& tool, const Eigen::Vector3d& p_m) {
  if (tool.surface->is_ball()) {
    return (p_m - tool.reference_m).norm() - tool.surface->ball_radius_m();
  }
  return tool.surface->distance_m(tool.rotation.transpose() * (p_m - tool.reference_m));
}

ToolDistance distance(const PlacedTool& tool, const Eigen::Vector3d& p_m) {
  const Eigen::Vector3d from_m = p_m - tool.reference_m;
  if (const double r_m = from_m.norm(); tool.surface->is_ball() && r_m > 0.0) {
    const Eigen::Vector3d n = from_m / r_m;
    return {r_m - tool.surface->ball_radius_m(), n,
            (Eigen::Matrix3d::Identity() - n * n.transpose()) / r_m};
  }
  ToolDistance d = tool.surface->distance(tool.rotation.transpose() * from_m);
  d.normal = tool.rotation * d.normal;
  d.curvature_per_m = tool.rotation * d.curvature_per_m * tool.rotation.transpose();
  return d;
}

double expected_contact_radius_m(const ToolShape& tool, double depth_m) {
  const auto of_ball = [&](double R) {
    return std::min(R, std::sqrt(R * depth_m));
  };
  if (tool.kind == "flat-punch") {
    return tool.radius_m;
  }
  if (tool.kind == "cone") {
    return std::max(
        2.0 / std::numbers::pi * reproducible::tan(tool.half_angle_rad) * depth_m,
        of_ball(tool.tip_radius_m));
  }
  if (tool.kind == "mesh") {
    return std::sqrt(shadow_area_m2(tool.mesh, depth_m) / std::numbers::pi);
  }
  return of_ball(tool.radius_m);
}

}  // namespace palpate
