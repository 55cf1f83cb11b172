#include "precompute/contact/contact_potential.h"

#include <algorithm>
#include <unordered_map>

#include <Eigen/Geometry>

#include "precompute/contact/face_quadrature.h"

namespace palpate {
namespace {

const FaceRulePoint& rule_point(std::int32_t i) {
  return face_rule()[static_cast<std::size_t>(i)];
}

// Projection on the tool's tangent plane at a tied node's anchor.
Eigen::Matrix3d tangent_plane(const PlacedTool& tool, const Eigen::Vector3d& anchor_m) {
  const Eigen::Vector3d n =
      tool.rotation *
      tool.surface->distance(tool.rotation.transpose() * anchor_m).normal;
  return Eigen::Matrix3d::Identity() - n * n.transpose();
}

double face_area_m2(const QuadraticMesh& mesh, Eigen::Index face) {
  const Eigen::Vector3d a = mesh.position_m.row(mesh.surface(face, 0)).transpose();
  const Eigen::Vector3d b = mesh.position_m.row(mesh.surface(face, 1)).transpose();
  const Eigen::Vector3d c = mesh.position_m.row(mesh.surface(face, 2)).transpose();
  return 0.5 * (b - a).cross(c - a).norm();
}

}  // namespace

double spring_give_m(const ContactState& contact, const Multipliers& multipliers) {
  const double sum_n = contact.pressure_n.sum();
  if (!(sum_n > 0.0)) {
    return 0.0;
  }
  const Eigen::VectorXd slip_m = (contact.tie_n - multipliers.tie_n)
                                     .rowwise()
                                     .norm()
                                     .cwiseQuotient(multipliers.spring_n_per_m);
  return (contact.pressure_n.dot(contact.gap_m.cwiseAbs()) +
          contact.tie_n.rowwise().norm().dot(slip_m)) /
         sum_n;
}

// omega_vq = psi_v(x_q) w_q A / A_v: hat psi_v at the point (rule.hat), area share w_q
// of the face's area A, area A_v of the hat. A row's `mean` of node j is sum_q omega_vq
// N_j. Points whose hats are all outside the patch carry no contact and are left out.
ContactPotential::ContactPotential(const ContactSurface& surface,
                                   const QuadraticMesh& mesh,
                                   std::span<const std::int32_t> patch,
                                   const NearField& near)
    : patch_size_(patch.size()), row_(patch.size()) {
  std::unordered_map<std::int32_t, std::int32_t> hat_of;  // of mesh nodes
  for (std::size_t v = 0; v < patch.size(); ++v) {
    hat_of.emplace(surface.node[static_cast<std::size_t>(patch[v])].mesh_node,
                   static_cast<std::int32_t>(v));
  }
  std::vector<Eigen::Index> faces;
  for (Eigen::Index f = 0; f < mesh.surface.rows(); ++f) {
    const auto row = mesh.surface.row(f);
    if (std::any_of(row.begin(), row.end(), [&](std::int32_t n) {
          return hat_of.contains(n);
        })) {
      faces.push_back(f);
    }
  }
  face_.resize(static_cast<Eigen::Index>(faces.size()), 6);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto nodes = mesh.surface.row(faces[i]);
    const double area = face_area_m2(mesh, faces[i]);
    std::array<std::int32_t, 6> hat{};
    for (int j = 0; j < 6; ++j) {
      face_(static_cast<Eigen::Index>(i), j) = near.near_node(nodes[j]);
      const auto found = hat_of.find(nodes[j]);
      hat[static_cast<std::size_t>(j)] = found == hat_of.end() ? -1 : found->second;
    }
    for (std::size_t q = 0; q < face_rule().size(); ++q) {
      const FaceRulePoint& rule = face_rule()[q];
      Point point;
      point.face = static_cast<std::int32_t>(i);
      point.rule = static_cast<std::int32_t>(q);
      point.position_m.setZero();
      for (int j = 0; j < 3; ++j) {
        point.position_m += rule.at[j] * mesh.position_m.row(nodes[j]).transpose();
      }
      std::size_t slot = 0;
      for (int j = 0; j < 6; ++j) {
        const std::int32_t v = hat[static_cast<std::size_t>(j)];
        if (rule.hat[j] != 0.0 && v >= 0) {
          const std::int32_t c = patch[static_cast<std::size_t>(v)];
          point.hat[slot] = v;
          point.omega[slot++] = rule.hat[j] * rule.area_share * area /
                                surface.node[static_cast<std::size_t>(c)].area_m2;
        }
      }
      if (slot > 0) {
        point_.push_back(point);
      }
    }
  }
  for (const Point& point : point_) {
    for (std::size_t h = 0; h < 3 && point.hat[h] >= 0; ++h) {
      for (int j = 0; j < 6; ++j) {
        row_entry(point.hat[h], face_(point.face, j)).mean +=
            point.omega[h] * rule_point(point.rule).shape[j];
      }
    }
  }
  row_spring_.assign(patch_size_, 0.0);
  tie_spring_.assign(patch_size_, Eigen::Matrix3d::Zero());
  curvature_ = BlockMatrix(static_cast<std::int32_t>(near.size() / 3), face_);
}

ContactPotential::RowEntry& ContactPotential::row_entry(std::int32_t hat,
                                                        std::int32_t node) {
  auto& row = row_[static_cast<std::size_t>(hat)];
  for (RowEntry& entry : row) {
    if (entry.node == node) {
      return entry;
    }
  }
  return row.emplace_back(RowEntry{node, Eigen::Vector3d::Zero(), 0.0});
}

double ContactPotential::pressure_at(const Point& point,
                                     const Eigen::VectorXd& pressure_n) {
  double pressure = 0.0;
  for (std::size_t h = 0; h < 3 && point.hat[h] >= 0; ++h) {
    pressure += point.omega[h] * pressure_n[point.hat[h]];
  }
  return pressure;
}

double ContactPotential::point_spring(const Point& point,
                                      const Multipliers& multipliers) {
  double spring = 0.0;
  for (std::size_t h = 0; h < 3 && point.hat[h] >= 0; ++h) {
    spring += point.omega[h] * multipliers.spring_n_per_m[point.hat[h]];
  }
  return multipliers.point_share * spring;
}

Eigen::Vector3d ContactPotential::displaced(const Point& point,
                                            const Eigen::VectorXd& u_m) const {
  const FaceRulePoint& rule = rule_point(point.rule);
  Eigen::Vector3d x = point.position_m;
  for (int j = 0; j < 6; ++j) {
    x += rule.shape[j] * u_m.segment<3>(3 * Eigen::Index{face_(point.face, j)});
  }
  return x;
}

Eigen::MatrixX3d ContactPotential::average_position_m(
    const Eigen::VectorXd& u_m) const {
  Eigen::MatrixX3d x = Eigen::MatrixX3d::Zero(nodes(), 3);
  for (const Point& point : point_) {
    const Eigen::Vector3d at = displaced(point, u_m);
    for (std::size_t h = 0; h < 3 && point.hat[h] >= 0; ++h) {
      x.row(point.hat[h]) += point.omega[h] * at.transpose();
    }
  }
  return x;
}

// 1. Gaps g_v = sum_q omega_vq phi_q.
// 2. Pressure forces p_v = <lambda_v - k_v g_v> and their energy.
// 3. Force on the tool -sum_q (sum_v omega_vq p_v + k_q <-phi_q>) grad phi, and its
//    moment.
// 4. Ties: slip s = P (x_v - reference - anchor), P the projection on the tangent
//    plane; force tau + k_v s, energy (|tau + k_v s|^2 - |tau|^2) / (2 k_v).
ContactState ContactPotential::evaluate(const Eigen::VectorXd& u_m,
                                        const PlacedTool& tool,
                                        const Multipliers& multipliers) const {
  ContactState state;
  state.force_n.setZero();
  state.moment_nm.setZero();
  state.gap_m = Eigen::VectorXd::Zero(nodes());
  std::vector<char> overlaps(point_.size(), 0);  // with springs at the points
  for (std::size_t p = 0; p < point_.size(); ++p) {
    const Point& point = point_[p];
    const double distance = distance_m(tool, displaced(point, u_m));
    for (std::size_t h = 0; h < 3 && point.hat[h] >= 0; ++h) {
      state.gap_m[point.hat[h]] += point.omega[h] * distance;
    }
    overlaps[p] = distance < 0.0 && multipliers.point_share > 0.0 ? 1 : 0;
  }
  const Eigen::VectorXd& k = multipliers.spring_n_per_m;
  const Eigen::VectorXd& lambda = multipliers.pressure_n;
  state.pressure_n = (lambda - k.cwiseProduct(state.gap_m)).cwiseMax(0.0);
  state.energy_j = ((state.pressure_n.array().square() - lambda.array().square()) /
                    (2.0 * k.array()))
                       .sum();
  for (std::size_t p = 0; p < point_.size(); ++p) {
    double push = pressure_at(point_[p], state.pressure_n);
    if (push == 0.0 && overlaps[p] == 0) {
      continue;  // most of them
    }
    const Eigen::Vector3d x = displaced(point_[p], u_m);
    const ToolDistance phi = distance(tool, x);
    if (overlaps[p] != 0) {
      const double spring = -point_spring(point_[p], multipliers) * phi.distance_m;
      state.energy_j -= 0.5 * spring * phi.distance_m;
      push += spring;
    }
    state.force_n -= push * phi.normal;
    state.moment_nm -= push * x.cross(phi.normal);
  }
  state.tie_n = Eigen::MatrixX3d::Zero(nodes(), 3);
  if (multipliers.tied.empty()) {
    return state;
  }
  const Eigen::MatrixX3d at = average_position_m(u_m);
  for (Eigen::Index v = 0; v < nodes(); ++v) {
    if (multipliers.tied[static_cast<std::size_t>(v)] != 0) {
      const Eigen::Vector3d anchor = multipliers.anchor_m.row(v).transpose();
      const Eigen::Vector3d x = at.row(v).transpose();
      const Eigen::Vector3d slip =
          tangent_plane(tool, anchor) * (x - tool.reference_m - anchor);
      const Eigen::Vector3d tau = multipliers.tie_n.row(v).transpose();
      const Eigen::Vector3d force = tau + k[v] * slip;
      state.tie_n.row(v) = force.transpose();
      state.energy_j += (force.squaredNorm() - tau.squaredNorm()) / (2.0 * k[v]);
      state.force_n += force;
      state.moment_nm += x.cross(force);
    }
  }
  return state;
}

// With dg_v = sum_q omega_vq N n_q, n = grad phi, H = Hessian of phi, c_q = <-phi_q>:
//   dPsi/du   = sum_v (-p_v dg_v + mean_v tie_v) - sum_q k_q c_q N n_q
//   d2Psi/du2 = sum_v (k_v dg_v dg_v^T + mean_v k_v P mean_v^T)
//               + sum_q N (k_q n n^T - (p_q + k_q c_q) H) N^T
// The sums over v are kept as rows; the first runs over active hats (p_v > 0). The sum
// over q is kept as one 18 x 18 block per face. Points are sorted by face.
void ContactPotential::linearise(const Eigen::VectorXd& u_m, const PlacedTool& tool,
                                 const Multipliers& multipliers,
                                 Eigen::VectorXd& force_n) {
  const ContactState state = evaluate(u_m, tool, multipliers);
  for (std::size_t v = 0; v < patch_size_; ++v) {
    for (RowEntry& entry : row_[v]) {
      entry.gradient.setZero();
    }
    const auto i = static_cast<Eigen::Index>(v);
    row_spring_[v] = state.pressure_n[i] > 0.0 ? multipliers.spring_n_per_m[i] : 0.0;
    const bool tied = !multipliers.tied.empty() && multipliers.tied[v] != 0;
    tie_spring_[v].setZero();
    if (tied) {
      tie_spring_[v] = multipliers.spring_n_per_m[i] *
                       tangent_plane(tool, multipliers.anchor_m.row(i).transpose());
    }
  }
  curvature_.set_zero();
  Eigen::Matrix<double, 18, 18> block = Eigen::Matrix<double, 18, 18>::Zero();
  for (std::size_t p = 0; p < point_.size(); ++p) {
    const Point& point = point_[p];
    const FaceRulePoint& rule = rule_point(point.rule);
    const double pressure = pressure_at(point, state.pressure_n);
    if (pressure > 0.0 || multipliers.point_share > 0.0) {
      const ToolDistance phi = distance(tool, displaced(point, u_m));
      const double overlap_m = std::max(0.0, -phi.distance_m);
      const double spring = overlap_m > 0.0 ? point_spring(point, multipliers) : 0.0;
      const Eigen::Matrix3d curvature =
          spring * phi.normal * phi.normal.transpose() -
          (pressure + spring * overlap_m) * phi.curvature_per_m;
      for (std::size_t h = 0; h < 3 && point.hat[h] >= 0; ++h) {
        for (int j = 0; j < 6; ++j) {
          row_entry(point.hat[h], face_(point.face, j)).gradient +=
              point.omega[h] * rule.shape[j] * phi.normal;
        }
      }
      for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 6; ++i) {
          block.block<3, 3>(3 * i, 3 * j) += rule.shape[i] * rule.shape[j] * curvature;
        }
        force_n.segment<3>(3 * Eigen::Index{face_(point.face, j)}) -=
            spring * overlap_m * rule.shape[j] * phi.normal;
      }
    }
    if (p + 1 == point_.size() || point_[p + 1].face != point.face) {
      curvature_.add(point.face, block);
      block.setZero();
    }
  }
  for (std::size_t v = 0; v < patch_size_; ++v) {
    const auto i = static_cast<Eigen::Index>(v);
    for (const RowEntry& entry : row_[v]) {
      force_n.segment<3>(3 * Eigen::Index{entry.node}) +=
          -state.pressure_n[i] * entry.gradient +
          entry.mean * state.tie_n.row(i).transpose();
    }
  }
}

void ContactPotential::add_curvature(const Eigen::VectorXd& x,
                                     Eigen::VectorXd& y) const {
  for (std::size_t v = 0; v < patch_size_; ++v) {
    if (row_spring_[v] == 0.0 && tie_spring_[v].isZero()) {
      continue;
    }
    // y += k_v dg_v (dg_v . x) + mean_v k_v P (mean_v . x).
    double along = 0.0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const RowEntry& entry : row_[v]) {
      const auto x_a = x.segment<3>(3 * Eigen::Index{entry.node});
      along += entry.gradient.dot(x_a);
      mean += entry.mean * x_a;
    }
    const Eigen::Vector3d tie = tie_spring_[v] * mean;
    for (const RowEntry& entry : row_[v]) {
      y.segment<3>(3 * Eigen::Index{entry.node}) +=
          row_spring_[v] * along * entry.gradient + entry.mean * tie;
    }
  }
  curvature_.multiply_add(x, y);
}

}  // namespace palpate
