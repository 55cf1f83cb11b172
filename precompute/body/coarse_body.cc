#include "precompute/body/coarse_body.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/surface/coarsen_surface.h"
#include "precompute/surface/refine_surface.h"

namespace palpate {
namespace {

// Edges over the distance from the nearest pressed vertex. At a cut twice as far away
// as the shortest edges are long they are still the shortest. Thin bodies may not be
// meshed well with edges much longer than they are thick: they get shorter ones.
constexpr std::array<double, 3> kGrowths{0.5, 0.25, 0.125};

SurfaceMesh coarse_surface(const Scene& scene, const BodySource& body,
                           const EdgeLength& wanted, double edge_m) {
  const CoarsenedSurface coarse =
      coarsen_surface(body.surface, wanted, {}, [&](const Eigen::Vector3d& p) {
        return support_part(scene, p);
      });
  SurfaceMesh surface = refine_longest_edge(coarse.surface, wanted, kMostTriangles);
  if (surface.triangle.rows() > kMostTriangles) {
    throw InputError(fmt::format(
        "[cutout] coarse_edge_m is {} m: the coarse body would have {} triangles or "
        "more, at most {} are allowed; choose longer edges",
        edge_m, surface.triangle.rows(), kMostTriangles));
  }
  return surface;
}

BodyModel coarse_model(const Scene& scene, const BodySource& body,
                       std::span<const std::int32_t> vertices, double edge_m) {
  std::string failure;
  for (const double growth : kGrowths) {
    const EdgeLength wanted =
        wanted_edges(body.surface, vertices, {.growth = growth, .finest_m = edge_m});
    try {
      return make_body_model(scene, body, coarse_surface(scene, body, wanted, edge_m));
    } catch (const NumericalError& error) {
      failure = error.what();
    }
  }
  throw NumericalError(fmt::format(
      "[cutout] coarse_edge_m is {} m: the coarse body cannot be made ({}); choose "
      "shorter edges",
      edge_m, failure));
}

// The contact nodes' unit pressure forces as forces on the coarse body: those degrees
// of freedom that any of them acts on, and (n x m) how much.
struct CoarseLoads {
  std::vector<std::int64_t> dof;
  Eigen::MatrixXd share;
};

CoarseLoads coarse_loads(const BodyModel& coarse, const TetLocator& where,
                         const BodyModel& part, std::span<const std::int32_t> nodes) {
  std::vector<std::map<std::int64_t, double>> row(nodes.size());
  std::map<std::int64_t, Eigen::Index> column;
  std::map<std::int32_t, TetLocator::Place> places;  // by node of the part
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const NodalForce& entry :
         part.contact.node[static_cast<std::size_t>(nodes[i])].load) {
      const auto [at, is_new] = places.try_emplace(entry.node);
      if (is_new) {
        at->second = where.place(part.mesh.position_m.row(entry.node).transpose());
      }
      const TetLocator::Place& place = at->second;
      // A force at a place inside a coarse tet acts on its ten nodes by their shape
      // functions.
      for (std::size_t a = 0; a < 10; ++a) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::int64_t dof =
              coarse.supports
                  .free_index[3 * static_cast<std::size_t>(place.node[a]) + axis];
          if (dof >= 0) {
            row[i][dof] += place.shape[static_cast<Eigen::Index>(a)] *
                           entry.force[static_cast<Eigen::Index>(axis)];
            column.try_emplace(dof, 0);
          }
        }
      }
    }
  }
  CoarseLoads loads;
  for (auto& [dof, index] : column) {
    index = static_cast<Eigen::Index>(loads.dof.size());
    loads.dof.push_back(dof);
  }
  loads.share.setZero(static_cast<Eigen::Index>(nodes.size()),
                      static_cast<Eigen::Index>(loads.dof.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const auto& [dof, value] : row[i]) {
      loads.share(static_cast<Eigen::Index>(i), column.at(dof)) = value;
    }
  }
  return loads;
}

// Displacements of the part's free degrees of freedom for those of its cut.
// @param cut_m (3 n_nodes x k), zero elsewhere.
Eigen::MatrixXd extended_m(const ClampedPart& part, const Eigen::MatrixXd& cut_m) {
  // K_ff u_f = -K_fc u_c: the part's free unknowns f follow those of its cut, c.
  const Eigen::MatrixXd force = part.stiffness.selfadjointView<Eigen::Lower>() * cut_m;
  const Supports& supports = part.model.supports;
  Eigen::MatrixXd B(supports.free, cut_m.cols());
  for (Eigen::Index i = 0; i < force.rows(); ++i) {
    const std::int64_t dof = supports.free_index[static_cast<std::size_t>(i)];
    if (dof >= 0) {
      B.row(dof) = -force.row(i);
    }
  }
  return part.model.factor->solve(B);
}

}  // namespace

CoarseBody::CoarseBody(const Scene& scene, const BodySource& body,
                       std::span<const std::int32_t> vertices, double edge_m)
    : CoarseBody(coarse_model(scene, body, vertices, edge_m)) {}

CoarseBody::CoarseBody(BodyModel model)
    : model_(std::move(model)), where_(model_.mesh) {}

Eigen::MatrixXd CoarseBody::at_m(const TetLocator::Place& place,
                                 const Eigen::MatrixXd& moved_m) const {
  Eigen::MatrixXd there_m = Eigen::MatrixXd::Zero(3, moved_m.cols());
  for (std::size_t a = 0; a < 10; ++a) {
    const auto node = static_cast<std::size_t>(place.node[a]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t dof = model_.supports.free_index[3 * node + axis];
      if (dof >= 0) {
        there_m.row(static_cast<Eigen::Index>(axis)) +=
            place.shape[static_cast<Eigen::Index>(a)] * moved_m.row(dof);
      }
    }
  }
  return there_m;
}

std::vector<TetLocator::Place> CoarseBody::places_of_cut(
    const ClampedPart& part) const {
  std::vector<TetLocator::Place> place;
  for (const std::int32_t node : part.cut) {
    place.push_back(where_.place(part.model.mesh.position_m.row(node).transpose()));
  }
  return place;
}

Eigen::MatrixXd CoarseBody::carried_m(const ClampedPart& part,
                                      std::span<const TetLocator::Place> place,
                                      const Eigen::MatrixXd& moved_m) const {
  Eigen::MatrixXd cut_m =
      Eigen::MatrixXd::Zero(3 * part.model.mesh.position_m.rows(), moved_m.cols());
  for (std::size_t i = 0; i < part.cut.size(); ++i) {
    cut_m.middleRows(3 * Eigen::Index{part.cut[i]}, 3) = at_m(place[i], moved_m);
  }
  return extended_m(part, cut_m);
}

Eigen::MatrixXd CoarseBody::carried_m(const ClampedPart& part,
                                      const Eigen::MatrixXd& moved_m) const {
  return carried_m(part, places_of_cut(part), moved_m);
}

Eigen::MatrixXd CoarseBody::displaced_m(const ClampedPart& part,
                                        std::span<const std::int32_t> nodes,
                                        const Eigen::MatrixXd& pressure_n) const {
  const CoarseLoads loads = coarse_loads(model_, where_, part.model, nodes);
  const Eigen::MatrixXd load_n = loads.share.transpose() * pressure_n;
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(model_.supports.free, pressure_n.cols());
  for (std::size_t k = 0; k < loads.dof.size(); ++k) {
    B.row(loads.dof[k]) = load_n.row(static_cast<Eigen::Index>(k));
  }
  return model_.factor->solve(B);
}

Eigen::MatrixXd CoarseBody::exterior_compliance(
    const ClampedPart& part, std::span<const std::int32_t> nodes) const {
  // Column y of the answer is the motion of contact nodes x under a load at y. The
  // coarse body moves, its motion at the cut carries the part, and nodes average that.
  // The coarse body's solves are shared by the m unknowns that loads act on.
  const CoarseLoads loads = coarse_loads(model_, where_, part.model, nodes);
  const std::vector<TetLocator::Place> place = places_of_cut(part);
  const auto n = static_cast<Eigen::Index>(nodes.size());
  const Eigen::Index m = loads.share.cols();
  constexpr auto kBlock = static_cast<Eigen::Index>(SurfaceCompliance::kBlock);
  Eigen::MatrixXd answer = Eigen::MatrixXd::Zero(n, n);  // of x to a load at y
  for (Eigen::Index first = 0; first < m; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, m - first);
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(model_.supports.free, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      B(loads.dof[static_cast<std::size_t>(first + k)], k) = 1.0;
    }
    const Eigen::MatrixXd inside_m = carried_m(part, place, model_.factor->solve(B));
    Eigen::MatrixXd moved_m(n, count);
    for (Eigen::Index i = 0; i < n; ++i) {
      const ContactNode& node =
          part.model.contact
              .node[static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)])];
      for (Eigen::Index k = 0; k < count; ++k) {
        moved_m(i, k) =
            average_displacement(node, part.model.supports, inside_m.col(k));
      }
    }
    answer += moved_m * loads.share.middleCols(first, count).transpose();
  }
  // Two meshes make the answer symmetric only to their error; Maxwell-Betti wants
  // symmetry.
  return 0.5 * (answer + answer.transpose());
}

}  // namespace palpate
