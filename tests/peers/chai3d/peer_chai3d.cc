// CHAI3D's finger-proxy algorithm on a triangle mesh, built against a folder of its
// sources that the user names (chai3d/build).
//
// Settings are its documentation's and examples': the proxy has the tool's radius, the
// collision detector is an AABB tree with that radius, the material has the scene's
// best single stiffness; tolerances are left at their defaults.
#include "forces/CAlgorithmFingerProxy.h"
#include "world/CMesh.h"
#include "world/CWorld.h"

#include <memory>

#include "tests/peers/entrants/entrant.h"
#include "tests/peers/entrants/scene_values.h"

namespace peers {
namespace {

using namespace chai3d;  // NOLINT(google-build-using-namespace)

class FingerProxy {
 public:
  static constexpr const char* kVariants[] = {"finger-proxy", "finger-proxy, shading",
                                              "finger-proxy, friction",
                                              "finger-proxy, shading, friction"};

  FingerProxy(const std::filesystem::path& scene, const std::filesystem::path&,
              const std::string& variant, double)
      : world_(std::make_unique<cWorld>()),
        proxy_(std::make_unique<cAlgorithmFingerProxy>()) {
    const SceneValues values(scene);
    const double radius_m = values.number("tool_radius_m");
    auto* mesh = new cMesh;  // the world's
    const SceneSurface surface = read_scene_surface(scene);
    for (const auto& v : surface.vertex) {
      mesh->newVertex(v[0], v[1], v[2]);
    }
    for (const auto& t : surface.triangle) {
      mesh->newTriangle(static_cast<unsigned>(t[0]), static_cast<unsigned>(t[1]),
                        static_cast<unsigned>(t[2]));
    }
    mesh->computeAllNormals();
    mesh->m_material->setStiffness(values.number("typed_stiffness_n_per_m"));
    mesh->m_material->setUseHapticShading(variant.find("shading") != std::string::npos);
    const bool friction = variant.find("friction") != std::string::npos;
    mesh->m_material->setUseHapticFriction(friction);
    mesh->m_material->setStaticFriction(friction ? values.number("friction") : 0.0);
    mesh->m_material->setDynamicFriction(friction ? values.number("friction") : 0.0);
    mesh->createAABBCollisionDetector(radius_m);
    world_->addChild(mesh);
    world_->computeGlobalPositions(true);
    proxy_->setProxyRadius(radius_m);
  }

  void pose(const Eigen::Vector3d& position_m) {
    position_.set(position_m.x(), position_m.y(), position_m.z());
    if (!placed_) {
      proxy_->initialize(world_.get(), position_);
      placed_ = true;
    }
  }

  Eigen::Vector3d force() {
    const cVector3d f = proxy_->computeForces(position_, cVector3d(0, 0, 0));
    return {f.x(), f.y(), f.z()};
  }

  void slow() {}

 private:
  std::unique_ptr<cWorld> world_;
  std::unique_ptr<cAlgorithmFingerProxy> proxy_;
  cVector3d position_;
  bool placed_ = false;
};

}  // namespace
}  // namespace peers

PEERS_ENTRANT(peers::FingerProxy)
