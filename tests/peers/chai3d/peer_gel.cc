// CHAI3D's GEL: a skeleton of masses and springs that moves in the haptic loop, built
// against a folder of CHAI3D's sources that the user names (chai3d/build).
//
// As in its example of a filled body: nodes are balls inside the surface and within, a
// link joins neighbours, a node in a support is fixed, and a penalty acts between the
// tool and every node that it touches. The links' stiffness is found in the first call,
// so that a press of 0.6 of the largest depth at the scene's site has the force of the
// scene's best single stiffness. Masses are those of the example, turning springs the
// same in proportion to the nodes' inertia, damping is chosen higher, in its favour:
// with the example's a press rings for seconds.
#include "GEL3D.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "tests/peers/entrants/entrant.h"
#include "tests/peers/entrants/scene_values.h"

namespace peers {
namespace {

using chai3d::cVector3d;
using Vectors = std::vector<Eigen::Vector3d>;

constexpr double kNodesAlong = 15.56;   // the body's longest side
constexpr double kNodeOfSpacing = 0.6;  // nodes' radius over their spacing
constexpr double kLinkOfSpacing = 1.7;  // longest link
constexpr double kMassKg = 0.002;       // of a node, as in its example
constexpr double kDampingPerS = 50.0;
constexpr double kTurnSpringOverInertia = 5e4;  // [1/s^2] as in its example
constexpr double kContactOverTyped = 2.0;       // penalty over the scene's stiffness
constexpr double kShare = 0.6;                  // of the depth, where it is tuned

cVector3d of(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

void add_apart(Vectors& nodes, const Eigen::Vector3d& p, double spacing) {
  if (std::none_of(nodes.begin(), nodes.end(), [&](const Eigen::Vector3d& q) {
        return (p - q).squaredNorm() < spacing * spacing;
      })) {
    nodes.push_back(p);
  }
}

// Of nodes, as its examples' bodies are divided.
double spacing_of(const SceneSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const auto& v : surface.vertex) {
    box.extend(Eigen::Vector3d(v[0], v[1], v[2]));
  }
  return box.sizes().maxCoeff() / kNodesAlong;
}

// Balls under the surface, then within the body.
Vectors node_positions(const SceneSurface& surface, double spacing) {
  Vectors vertex;
  for (const auto& v : surface.vertex) {
    vertex.emplace_back(v[0], v[1], v[2]);
  }
  Vectors normal(vertex.size(), Eigen::Vector3d::Zero());
  for (const auto& t : surface.triangle) {
    const auto at = [&](int k) -> const Eigen::Vector3d& {
      return vertex[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
    };
    const Eigen::Vector3d area = (at(1) - at(0)).cross(at(2) - at(0));
    for (const int corner : t) {
      normal[static_cast<std::size_t>(corner)] += area;
    }
  }
  Vectors nodes;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    add_apart(nodes, vertex[i] - kNodeOfSpacing * spacing * normal[i].normalized(),
              0.95 * spacing);
    box.extend(vertex[i]);
  }
  const auto inside = [&](const Eigen::Vector3d& p) {
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      if ((vertex[i] - p).squaredNorm() < (vertex[nearest] - p).squaredNorm()) {
        nearest = i;
      }
    }
    return (p - vertex[nearest]).dot(normal[nearest].normalized()) < -1.4 * spacing;
  };
  for (double x = box.min().x(); x < box.max().x(); x += spacing) {
    for (double y = box.min().y(); y < box.max().y(); y += spacing) {
      for (double z = box.min().z(); z < box.max().z(); z += spacing) {
        if (inside({x, y, z})) {
          add_apart(nodes, {x, y, z}, 0.95 * spacing);
        }
      }
    }
  }
  return nodes;
}

class Gel {
 public:
  static constexpr const char* kVariants[] = {"skeleton"};

  Gel(const std::filesystem::path& scene, const std::filesystem::path& own,
      const std::string&, double tick_s)
      : values_(scene), tick_s_(tick_s), radius_m_(values_.number("tool_radius_m")) {
    (void)values_.numbers("support_box_m");
    const SceneSurface surface = read_scene_surface(scene);
    spacing_m_ = spacing_of(surface);
    positions_ = node_positions(surface, spacing_m_);
    const std::filesystem::path known = own / "link_stiffness.txt";
    double link = 0.0;
    if (!(std::ifstream(known) >> link)) {
      link = tuned();
      std::ofstream(known) << link << '\n';
    }
    build(link);
  }

  void pose(const Eigen::Vector3d& position_m) { centre_m_ = position_m; }

  Eigen::Vector3d force() {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const double touch_m = radius_m_ + node_radius_m();
    for (cGELSkeletonNode* node : nodes_) {
      const Eigen::Vector3d away =
          centre_m_ -
          Eigen::Vector3d(node->m_pos.x(), node->m_pos.y(), node->m_pos.z());
      const double distance = away.norm();
      Eigen::Vector3d f = Eigen::Vector3d::Zero();
      if (distance < touch_m && distance > 0.0) {
        f = contact_n_per_m_ * (touch_m - distance) / distance * away;
      }
      cVector3d back = of(-f);
      node->setExternalForce(back);
      sum += f;
    }
    world_->updateDynamics(tick_s_);
    return sum;
  }

  void slow() {}

 private:
  [[nodiscard]] double node_radius_m() const { return kNodeOfSpacing * spacing_m_; }

  [[nodiscard]] bool held(const Eigen::Vector3d& p) const {
    const std::vector<double> box = values_.numbers("support_box_m");
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(1.2 * node_radius_m());
    return Eigen::AlignedBox3d(Eigen::Vector3d(box.data()) - reach,
                               Eigen::Vector3d(box.data() + 3) + reach)
        .contains(p);
  }

  void build(double link_n_per_m) {
    contact_n_per_m_ = kContactOverTyped * values_.number("typed_stiffness_n_per_m");
    world_ = std::make_unique<cGELWorld>();
    auto* body = new cGELMesh;  // the world's
    world_->m_gelMeshes.push_front(body);
    body->m_useSkeletonModel = true;
    body->m_useMassParticleModel = false;
    nodes_.clear();
    for (const Eigen::Vector3d& p : positions_) {
      auto* node = new cGELSkeletonNode;  // the body's
      node->m_pos = of(p);
      node->m_rot.identity();
      node->m_radius = node_radius_m();
      node->setMass(kMassKg);
      node->m_kDampingPos = kDampingPerS;
      node->m_kDampingRot = kDampingPerS;
      node->m_useGravity = false;
      node->m_fixed = held(p);
      body->m_nodes.push_front(node);
      nodes_.push_back(node);
    }
    const double turn = kTurnSpringOverInertia * nodes_.front()->m_inertia;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      for (std::size_t j = i + 1; j < nodes_.size(); ++j) {
        if ((positions_[i] - positions_[j]).norm() < kLinkOfSpacing * spacing_m_) {
          auto* link = new cGELSkeletonLink(nodes_[i], nodes_[j]);  // the body's
          link->m_kSpringElongation = link_n_per_m;
          link->m_kSpringFlexion = turn;
          link->m_kSpringTorsion = turn;
          body->m_links.push_front(link);
        }
      }
    }
  }

  // Force of a slow press at the site.
  double pressed_n(double link_n_per_m) {
    build(link_n_per_m);
    const std::vector<double> at = values_.numbers("site_m");
    const std::vector<double> out = values_.numbers("site_normal");
    const Eigen::Vector3d n(out.data());
    const double depth_m = kShare * values_.number("depth_max_m");
    double f = 0.0;
    for (int i = 0; i < 600; ++i) {
      const double d = depth_m * std::min(1.0, i / 200.0);
      pose(Eigen::Vector3d(at.data()) + (radius_m_ - d) * n);
      f = force().dot(n);
    }
    return f;
  }

  // Stiffer links push more: by bisection of their logarithm.
  double tuned() {
    const double wanted = kShare * values_.number("depth_max_m") *
                          values_.number("typed_stiffness_n_per_m");
    double low = 0.1;
    double high = 600.0;  // above, Euler's steps at 1 kHz diverge
    for (int i = 0; i < 12; ++i) {
      const double middle = std::sqrt(low * high);
      (pressed_n(middle) < wanted ? low : high) = middle;
    }
    return low;
  }

  SceneValues values_;
  double tick_s_;
  double radius_m_;
  double spacing_m_ = 0.0;
  double contact_n_per_m_ = 0.0;
  Vectors positions_;
  std::unique_ptr<cGELWorld> world_;
  std::vector<cGELSkeletonNode*> nodes_;
  Eigen::Vector3d centre_m_ = Eigen::Vector3d::Zero();
};

}  // namespace
}  // namespace peers

PEERS_ENTRANT(peers::Gel)
