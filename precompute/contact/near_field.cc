#include "precompute/contact/near_field.h"

#include <algorithm>
#include <cmath>

namespace palpate {

NearField::NearField(const QuadraticMesh& mesh, std::span<const Material> materials,
                     const Supports& supports, std::span<const Eigen::Index> tets,
                     std::span<const std::int32_t> nodes)
    : node_(nodes.begin(), nodes.end()) {
  // 1. Elements of nonlinear laws, and their nodes besides those asked for.
  std::vector<Eigen::Index> nonlinear;
  std::vector<std::int32_t> region;
  std::vector<ElementGeometry> geometry;
  for (const Eigen::Index tet : tets) {
    const std::int32_t of_tet = region_of(mesh, tet);
    if (!is_linear(materials[static_cast<std::size_t>(of_tet)])) {
      nonlinear.push_back(tet);
      region.push_back(of_tet);
      geometry.push_back(element_geometry(tet_corners(mesh, tet), tet));
      for (int j = 0; j < 10; ++j) {
        node_.push_back(mesh.tet(tet, j));
      }
    }
  }
  std::sort(node_.begin(), node_.end());
  node_.erase(std::unique(node_.begin(), node_.end()), node_.end());
  // 2. Unknowns of the near nodes, -1 where held; three for each node.
  dof_.reserve(3 * node_.size());
  for (const std::int32_t node : node_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      dof_.push_back(supports.free_index[3 * static_cast<std::size_t>(node) + axis]);
    }
  }
  // 3. The rest stiffness K_e of those elements: their tangent at u = 0.
  NodeGroups groups(static_cast<Eigen::Index>(nonlinear.size()), 10);
  for (std::size_t e = 0; e < nonlinear.size(); ++e) {
    for (int j = 0; j < 10; ++j) {
      groups(static_cast<Eigen::Index>(e), j) = near_node(mesh.tet(nonlinear[e], j));
    }
  }
  rest_ = BlockMatrix(static_cast<std::int32_t>(node_.size()), groups);
  change_ = rest_;
  elements_ = ElementBatches(std::move(groups), geometry, region, materials);
  elements_.linearise(
      Eigen::VectorXd::Zero(size()), false,
      [&](const auto& batch, const BatchResponse& response) {
        rest_.add({batch.element.data(), batch.count}, response.stiffness);
      });
}

std::int32_t NearField::near_node(std::int32_t mesh_node) const {
  const auto at = std::lower_bound(node_.begin(), node_.end(), mesh_node);
  return at != node_.end() && *at == mesh_node
             ? static_cast<std::int32_t>(at - node_.begin())
             : -1;
}

void NearField::mask(Eigen::VectorXd& v) const {
  for (std::size_t i = 0; i < dof_.size(); ++i) {
    if (dof_[i] < 0) {
      v[static_cast<Eigen::Index>(i)] = 0.0;
    }
  }
}

ElementBatches::Energy NearField::excess(const Eigen::VectorXd& u_m) const {
  // sum_e W_e(u_e) - u . K_e u / 2.
  ElementBatches::Energy excess = elements_.energy(u_m);
  excess.energy_j -= 0.5 * rest_.quadratic_form(u_m);
  return excess;
}

void NearField::linearise(const Eigen::VectorXd& u_m, Eigen::VectorXd& force_n,
                          bool convex) {
  // change = sum_e (d2W_e/du2 - K_e). The first product adds -K_e u to the force, the
  // elements add dW_e/du.
  change_.set_negative(rest_);
  change_.multiply_add(u_m, force_n);
  elements_.linearise(
      u_m, convex, [&](const auto& batch, const BatchResponse& response) {
        change_.add({batch.element.data(), batch.count}, response.stiffness);
        elements_.add_forces(batch, response, force_n);
      });
}

namespace {

const Material& tet_material(const QuadraticMesh& mesh,
                             std::span<const Material> materials, Eigen::Index tet) {
  return materials[static_cast<std::size_t>(region_of(mesh, tet))];
}

}  // namespace

std::vector<Eigen::Index> strained_tets(const QuadraticMesh& mesh,
                                        std::span<const Material> materials,
                                        const Eigen::VectorXd& u_m, double threshold) {
  std::vector<Eigen::Index> tets;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    if (has_kink(tet_material(mesh, materials, t)) ||
        largest_gradient(element_geometry(tet_corners(mesh, t), t),
                         nodal_values(mesh, t, u_m)) >= threshold) {
      tets.push_back(t);
    }
  }
  return tets;
}

double far_excess_j(const QuadraticMesh& mesh, std::span<const Material> materials,
                    std::span<const Eigen::Index> near, const Eigen::VectorXd& u_m) {
  double excess = 0.0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    const Material& material = tet_material(mesh, materials, t);
    if (is_linear(material) || std::binary_search(near.begin(), near.end(), t)) {
      continue;
    }
    const ElementGeometry geometry = element_geometry(tet_corners(mesh, t), t);
    const ElementVector u = nodal_values(mesh, t, u_m);
    const ElementMatrix rest =
        element_response(geometry, material, ElementVector::Zero()).stiffness;
    excess += std::abs(element_energy(geometry, material, u) - 0.5 * u.dot(rest * u));
  }
  return excess;
}

double nonlinearity(const QuadraticMesh& mesh, std::span<const Material> materials,
                    const Eigen::VectorXd& u_m) {
  // sum_e W_e(u_e) / (sum_e u_e . K_e u_e / 2) - 1, K_e the tangent at rest. The sums
  // run over elements whose largest displacement gradient is at least kLeast of the
  // body's.
  constexpr double kLeast = 0.05;
  constexpr double kMost = 10.0;
  std::vector<double> gradient;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    gradient.push_back(largest_gradient(element_geometry(tet_corners(mesh, t), t),
                                        nodal_values(mesh, t, u_m)));
  }
  const double least = kLeast * *std::max_element(gradient.begin(), gradient.end());
  double energy_j = 0.0;
  double linear_j = 0.0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    if (gradient[static_cast<std::size_t>(t)] < least) {
      continue;
    }
    const Material& material = tet_material(mesh, materials, t);
    const ElementGeometry geometry = element_geometry(tet_corners(mesh, t), t);
    const ElementVector u = nodal_values(mesh, t, u_m);
    const ElementMatrix rest =
        element_response(geometry, material, ElementVector::Zero()).stiffness;
    linear_j += 0.5 * u.dot(rest * u);
    energy_j += element_energy(geometry, material, u);
  }
  return linear_j > 0.0 ? std::min(kMost, energy_j / linear_j - 1.0) : 0.0;
}

}  // namespace palpate
