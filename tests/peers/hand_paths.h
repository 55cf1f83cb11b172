// Hands that move over a body: where the tool is at every tick, and at which ticks the
// truth is wanted.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate::peers {

/// A place of the surface, and how deep the tool is there along its normal.
struct PlacedDepth {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  ///< unit, between the vertices'
  double depth_m = 0.0;                                ///< negative: above the surface
};

struct PlannedHand {
  std::string name;
  std::vector<PlacedDepth> tick;        ///< one each millisecond
  std::vector<std::size_t> truth_tick;  ///< ascending
  /// Ticks as far apart as kDenseTicks: of the slowest slide, along its contact.
  std::vector<std::size_t> dense_tick = {};
};

/// Half a millimetre of the slowest slide: 25 ms, so that 20 Hz are still told.
constexpr std::size_t kDenseTicks = 25;

/// A frame on the surface. Places have coordinates (u, v) [m] in the tangent plane of a
/// site, and are brought down to the surface along the site's normal.
class SurfaceFrame {
 public:
  /// @param near the site is the point of the surface nearest to it. @param along
  /// direction of u, across the normal. @throws InputError if it lies along the normal.
  SurfaceFrame(const SurfaceMesh& surface, const Eigen::Vector3d& near_m,
               const Eigen::Vector3d& along);

  /// @throws InputError where the surface does not reach under (u, v).
  [[nodiscard]] PlacedDepth place(double u_m, double v_m, double depth_m) const;

  /// (u, v) of a point.
  [[nodiscard]] Eigen::Vector2d coordinates(const Eigen::Vector3d& p_m) const;

 private:
  const SurfaceMesh& surface_;
  Points normal_;
  Eigen::Vector3d site_m_;
  Eigen::Matrix3d axes_;  // rows: u, v, normal
};

/// What the hands of a scene are made of.
struct HandRecipe {
  double depth_max_m = 0.005;
  double half_slide_m = 0.025;  ///< slides go from -that to +that along u
  Eigen::Vector2d circle_m = Eigen::Vector2d::Zero();  ///< its centre (u, v)
  double circle_radius_m = 0.012;
  int slide_points = 20;  ///< ticks with truth, of each slide in contact
  int circle_points = 16;
  int walk_points = 20;
  bool dense_truth = true;  ///< of the slowest slide
};

/// press: three places, one after the other, to the largest depth and back, 1 s each.
/// slide-20, -50, -100 [mm/s]: at 0.6 of the depth, the same places with truth. circle:
/// once around in 2 s. poke: three times a second, one second. walk: smooth and random,
/// 4 s, also out of the surface. cycle: pressed a little, 8 mm on, pressed deep, 8 mm
/// back, out; cycle-back: the same in reverse. All begin and end in free space.
[[nodiscard]] std::vector<PlannedHand> plan_hands(const SurfaceFrame& frame,
                                                  const HandRecipe& recipe);

}  // namespace palpate::peers
