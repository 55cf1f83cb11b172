// One stiffness, typed by hand, as most simulators have it: the ball is pushed out of
// the nearest point of the surface. The stiffness is the scene's best one.
#include <cmath>
#include <memory>

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
    if (nearest.distance_m >= radius_m_ || nearest.distance_m == 0.0) {
      return Eigen::Vector3d::Zero();
    }
    // The ball is larger than any depth: its centre stays outside.
    return stiffness_n_per_m_ * (radius_m_ - nearest.distance_m) *
           (centre_m_ - nearest.position_m) / nearest.distance_m;
  }

  void slow() {}

 private:
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
