// One stiffness, typed by hand, as most simulators have it: the ball is pushed out of
// the nearest point of the surface. The stiffness is the scene's best one.
#include <memory>

#include <Eigen/Geometry>

#include "formats/mesh/surface_reader.h"
#include "formats/mesh/surface_search.h"
#include "tests/peers/entrants/entrant.h"
#include "tests/peers/entrants/scene_values.h"

namespace peers {
namespace {

class Spring {
 public:
  static constexpr const char* kVariants[] = {"one stiffness"};

  Spring(const std::filesystem::path& scene, const std::filesystem::path&,
         const std::string&, double)
      : surface_(std::make_unique<palpate::SurfaceMesh>(
            palpate::read_surface(scene / "surface.obj", "m"))),
        search_(std::make_unique<palpate::SurfaceSearch>(*surface_)) {
    const SceneValues values(scene);
    radius_m_ = values.number("tool_radius_m");
    stiffness_n_per_m_ = values.number("typed_stiffness_n_per_m");
  }

  void pose(const Eigen::Vector3d& position_m) { centre_m_ = position_m; }

  Eigen::Vector3d force() {
    const palpate::SurfacePoint nearest = triangle_ < 0
                                              ? search_->nearest(centre_m_)
                                              : search_->walk(centre_m_, triangle_);
    triangle_ = nearest.distance_m < 2.0 * radius_m_ ? nearest.triangle : -1;
    // Where the centre has come inside, out is the other way.
    const Eigen::Vector3d away = centre_m_ - nearest.position_m;
    const Eigen::Vector3d normal = face_normal(nearest.triangle).normalized();
    const double out = away.dot(normal) < 0.0 ? -1.0 : 1.0;
    const double depth_m = radius_m_ - out * nearest.distance_m;
    if (depth_m <= 0.0) {
      return Eigen::Vector3d::Zero();
    }
    constexpr double kOnTheSurfaceM = 1e-9;  // where `away` has no direction
    const Eigen::Vector3d direction =
        nearest.distance_m > kOnTheSurfaceM ? out * away / nearest.distance_m : normal;
    return stiffness_n_per_m_ * depth_m * direction;
  }

  void slow() {}

 private:
  [[nodiscard]] Eigen::Vector3d face_normal(std::int32_t triangle) const {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return surface_->position_m.row(surface_->triangle(triangle, k)).transpose();
    };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }

  std::unique_ptr<palpate::SurfaceMesh> surface_;  // search_ refers to it
  std::unique_ptr<palpate::SurfaceSearch> search_;
  double radius_m_ = 0.0;
  double stiffness_n_per_m_ = 0.0;
  Eigen::Vector3d centre_m_ = Eigen::Vector3d::Zero();
  std::int32_t triangle_ = -1;
};

}  // namespace
}  // namespace peers

PEERS_ENTRANT(peers::Spring)
