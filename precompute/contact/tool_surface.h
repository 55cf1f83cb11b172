// Geometry of a rigid convex tool: distance, support, where it stands on its path.
//
// A kind that turns about an axis is a ball of radius rho rolled along the outline of a
// sharp core. The core lies in the half plane (s, z), s = distance from the axis. The
// distance to the tool = distance to the core - rho. The cores are:
// - sphere: a point;
// - capsule: a segment;
// - flat punch: an endless cylinder of radius R - edge;
// - cone: a sharp cone with its apex at the centre of the tip's sphere.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "formats/response/tool_shape.h"

namespace palpate {

struct ToolDistance {
  double distance_m = 0.0;          ///< [m] signed, positive outside
  Eigen::Vector3d normal;           ///< [-] unit: its gradient, away from the tool
  Eigen::Matrix3d curvature_per_m;  ///< [1/m] its Hessian
};

/// A piece of a core's outline in the half plane (s, z): base + t direction, t in
/// [0, length]; the core lies to its left.
struct OutlineEdge {
  Eigen::Vector2d base_m;
  Eigen::Vector2d direction;  ///< [-] unit
  double length_m = 0.0;      ///< [m] [0, inf]; inf only for the last
};

/// In the tool's frame (formats/response/tool_shape.h). Immutable, safe to share by
/// threads.
class ToolSurface {
 public:
  /// @throws InputError as check(ToolShape).
  explicit ToolSurface(const ToolShape& shape);

  [[nodiscard]] const ToolShape& shape() const { return shape_; }

  /// Exact Euclidean distance to the surface, also inside. The distance is C1 outside,
  /// and inside down to the depth of the smallest radius of curvature. The gradient is
  /// not unique at some places: a sphere's centre, a sharp edge from inside. The
  /// gradient there is one of the possible ones. The curvature is that of the smooth
  /// piece.
  [[nodiscard]] ToolDistance distance(const Eigen::Vector3d& p_m) const;
  /// [m] The distance alone, at a part of the cost.
  [[nodiscard]] double distance_m(const Eigen::Vector3d& p_m) const;

  /// Largest x . direction over the tool [m per unit of direction]; inf where the tool
  /// has no end that way.
  [[nodiscard]] double support_m(const Eigen::Vector3d& direction) const;

  /// Width across the axis [m]; of a cone without height that of its tip's sphere.
  [[nodiscard]] double extent_m() const;

  /// Whether it looks the same from all sides about its axis (every kind but a mesh).
  [[nodiscard]] bool turns_about_axis() const { return !outline_.empty(); }

  /// Whether it is a sphere, the same from everywhere.
  [[nodiscard]] bool is_ball() const { return is_ball_; }

  /// Of kinds that turn about the axis: the core's outline, from the axis outwards and
  /// up, and the radius of the ball.
  [[nodiscard]] const std::vector<OutlineEdge>& outline() const { return outline_; }
  [[nodiscard]] double ball_radius_m() const { return ball_radius_m_; }

  /// Cosine of the steepest inclination to the horizontal, for a press along the axis,
  /// at which the near side still counts. Beyond, contact laws go on straight with that
  /// slope. The value is 0.312 (a sphere at s = 0.95 R), and smaller for needles, so
  /// that their flanks count.
  [[nodiscard]] double steepest_cosine() const { return steepest_cosine_; }

 private:
  void set_planes();
  [[nodiscard]] ToolDistance distance_to_core(const Eigen::Vector3d& p_m) const;
  [[nodiscard]] ToolDistance distance_to_mesh(const Eigen::Vector3d& p_m) const;

  ToolShape shape_;
  std::vector<OutlineEdge> outline_;  // empty for a mesh
  double ball_radius_m_ = 0.0;
  bool is_ball_ = false;
  double steepest_cosine_ = 0.0;
  Eigen::MatrixX3d plane_normal_;  // (n_triangles x 3) of a mesh
  Eigen::VectorXd plane_offset_m_;
  double rounding_m_ = 0.0;  // of heights above these planes
  double slack_m_ = 0.0;     // by which faces that meet may not be convex
};

/// A tool at a place.
struct PlacedTool {
  const ToolSurface* surface = nullptr;
  Eigen::Matrix3d rotation;     ///< [-] from the tool's frame to the world
  Eigen::Vector3d reference_m;  ///< [m] of the tool's reference point
  Eigen::Vector3d press;        ///< [-] unit, from the body to where the tool came from
};

/// The tool on its path at normal penetration delta. The tool's lowest point along the
/// path has passed the vertex by delta: reference = vertex + (support(-outward) -
/// delta) outward. For a sphere: vertex + (R - delta) outward. The reference is not
/// finite where the tool has no end towards the body: its handle would be in the way.
[[nodiscard]] PlacedTool place_on_path(const ToolSurface& surface,
                                       const Eigen::Vector3d& vertex_m,
                                       const Eigen::Vector3d& outward,
                                       double penetration_m);

/// Distance of a point of the world; normal and curvature in the world's frame.
[[nodiscard]] ToolDistance distance(const PlacedTool& tool, const Eigen::Vector3d& p_m);
[[nodiscard]] double distance_m(const PlacedTool& tool, const Eigen::Vector3d& p_m);

/// Expected radius of the contact [m] at a depth [m] on a flat elastic half-space, for
/// sizing meshes:
/// - sphere and capsule: min(R, sqrt(R d));
/// - flat punch: R;
/// - cone: the larger of (2 / pi) d tan(half-angle) (Sneddon 1965) and the radius of
///   its tip's sphere;
/// - mesh: the radius of a disc with the area of the tool's shadow at that depth.
[[nodiscard]] double expected_contact_radius_m(const ToolShape& tool, double depth_m);

}  // namespace palpate
