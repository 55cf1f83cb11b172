#include "precompute/contact/near_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace palpate {
namespace {

// Most elements turn little and pass at the price of a factor: their negative
// eigenvalues, those of rotations under pressure, are small, and the others make up for
// them.
constexpr double kNegligible = 0.01;  // [-] of the mean diagonal

bool is_definite(const ElementMatrix& stiffness) {
  ElementMatrix shifted = stiffness;
  shifted.diagonal().array() += kNegligible * stiffness.diagonal().mean();
  return Eigen::LLT<ElementMatrix>(shifted).info() == Eigen::Success;
}

void sort_unique(std::vector<std::int32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

NearField::NearField(const QuadraticMesh& mesh, std::span<const Material> materials,
                     const Supports& supports, std::span<const Eigen::Index> tets,
                     std::span<const std::int32_t> nodes)
    : materials_(materials), node_(nodes.begin(), nodes.end()) {
  std::vector<Eigen::Index> nonlinear;
  for (const Eigen::Index tet : tets) {
    const std::int32_t region = region_of(mesh, tet);
    if (!is_linear(materials[static_cast<std::size_t>(region)])) {
      nonlinear.push_back(tet);
      region_.push_back(region);
      geometry_.push_back(element_geometry(tet_corners(mesh, tet), tet));
      for (int j = 0; j < 10; ++j) {
        node_.push_back(mesh.tet(tet, j));
      }
    }
  }
  sort_unique(node_);
  dof_.reserve(3 * node_.size());
  for (const std::int32_t node : node_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      dof_.push_back(supports.free_index[3 * static_cast<std::size_t>(node) + axis]);
    }
  }
  element_.resize(static_cast<Eigen::Index>(nonlinear.size()), 10);
  for (std::size_t e = 0; e < nonlinear.size(); ++e) {
    for (int j = 0; j < 10; ++j) {
      element_(static_cast<Eigen::Index>(e), j) = near_node(mesh.tet(nonlinear[e], j));
    }
  }
  rest_ = BlockMatrix(static_cast<std::int32_t>(node_.size()), element_);
  change_ = rest_;
  for (std::size_t e = 0; e < nonlinear.size(); ++e) {
    const Material& material = materials_[static_cast<std::size_t>(region_[e])];
    rest_.add(
        static_cast<Eigen::Index>(e),
        element_response(geometry_[e], material, ElementVector::Zero()).stiffness);
  }
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

ElementVector NearField::gather(Eigen::Index e, const Eigen::VectorXd& v) const {
  ElementVector u;
  for (Eigen::Index j = 0; j < 10; ++j) {
    u.segment<3>(3 * j) = v.segment<3>(3 * Eigen::Index{element_(e, j)});
  }
  return u;
}

double NearField::excess_energy_j(const Eigen::VectorXd& u_m) const {
  double energy = -0.5 * rest_.quadratic_form(u_m);
  for (Eigen::Index e = 0; e < element_.rows(); ++e) {
    const auto i = static_cast<std::size_t>(e);
    energy += element_energy(
        geometry_[i], materials_[static_cast<std::size_t>(region_[i])], gather(e, u_m));
    if (!(energy < std::numeric_limits<double>::infinity())) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return energy;
}

void NearField::linearise(const Eigen::VectorXd& u_m, Eigen::VectorXd& force_n,
                          bool convex) {
  change_ = rest_;
  change_.scale(-1.0);
  change_.multiply_add(u_m, force_n);
  for (Eigen::Index e = 0; e < element_.rows(); ++e) {
    const auto i = static_cast<std::size_t>(e);
    const Material& material = materials_[static_cast<std::size_t>(region_[i])];
    ElementLinearisation response =
        element_response(geometry_[i], material, gather(e, u_m));
    if (convex && !is_definite(response.stiffness)) {
      response = element_response(geometry_[i], material, gather(e, u_m), true);
    }
    change_.add(e, response.stiffness);
    for (Eigen::Index j = 0; j < 10; ++j) {
      force_n.segment<3>(3 * Eigen::Index{element_(e, j)}) +=
          response.force_n.segment<3>(3 * j);
    }
  }
}

double NearField::smallest_jacobian(const Eigen::VectorXd& u_m) const {
  double smallest = 1.0;
  for (Eigen::Index e = 0; e < element_.rows(); ++e) {
    smallest =
        std::min(smallest, palpate::smallest_jacobian(
                               geometry_[static_cast<std::size_t>(e)], gather(e, u_m)));
  }
  return smallest;
}

namespace {

const Material& material_of(const QuadraticMesh& mesh,
                            std::span<const Material> materials, Eigen::Index tet) {
  return materials[static_cast<std::size_t>(region_of(mesh, tet))];
}

}  // namespace

std::vector<Eigen::Index> strained_tets(const QuadraticMesh& mesh,
                                        std::span<const Material> materials,
                                        const Eigen::VectorXd& u_m, double threshold) {
  std::vector<Eigen::Index> tets;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    if (has_kink(material_of(mesh, materials, t)) ||
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
    const Material& material = material_of(mesh, materials, t);
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
    const Material& material = material_of(mesh, materials, t);
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
