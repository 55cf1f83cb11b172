#include "runtime/device/wrench_margin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/format.h>

namespace palpate {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Symmetric = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

// Axes and diagonals of space, one of each pair of opposites.
std::vector<Eigen::Vector3d> directions() {
  std::vector<Eigen::Vector3d> all;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (9 * x + 3 * y + z > 0) {
          all.push_back(Eigen::Vector3d(x, y, z).normalized());
        }
      }
    }
  }
  return all;
}

// Rows (e, r x e) of every contact: how far it moves along e.
Eigen::MatrixXd jacobian(const ContactStiffness& contacts, const Eigen::Vector3d& e) {
  Eigen::MatrixXd rows(contacts.lever_m.rows(), 6);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Eigen::Vector3d r = contacts.lever_m.row(i).transpose();
    rows.row(i).head<3>() = e.transpose();
    rows.row(i).tail<3>() = r.cross(e).transpose();
  }
  return rows;
}

Matrix6d stiffness_along(const ContactStiffness& contacts, const Eigen::Vector3d& n) {
  const Eigen::MatrixXd along = jacobian(contacts, n);
  Matrix6d k = along.transpose() * contacts.n_per_m * along;
  const Eigen::Vector3d side = n.unitOrthogonal();
  for (const Eigen::Vector3d& e : {side, Eigen::Vector3d(n.cross(side))}) {
    const Eigen::MatrixXd across = jacobian(contacts, e);
    k += contacts.friction_n_per_m * across.transpose() * across;
  }
  return k;
}

}  // namespace

WrenchMargin wrench_margin(const ContactStiffness& contacts, double linear_n_s_per_m,
                           double angular_n_m_s, double hold_s, double delay_s) {
  WrenchMargin worst;
  const int axes = angular_n_m_s > 0.0 ? 6 : 3;
  Eigen::VectorXd root(axes);  // sqrt of what a unit of B takes
  root.head(3).setConstant(std::sqrt((0.5 * hold_s + delay_s) / linear_n_s_per_m));
  if (axes == 6) {
    root.tail(3).setConstant(std::sqrt((0.5 * hold_s + delay_s) / angular_n_m_s));
  }
  for (const Eigen::Vector3d& n : directions()) {
    const Matrix6d k = stiffness_along(contacts, n);
    const Eigen::MatrixXd scaled =
        root.asDiagonal() * k.topLeftCorner(axes, axes) * root.asDiagonal();
    const Symmetric found(scaled);
    const double share = found.eigenvalues()(axes - 1);
    if (share > worst.share) {
      worst.share = share;
      worst.angular_share =
          axes == 6 ? found.eigenvectors().col(5).tail(3).squaredNorm() : 0.0;
    }
    worst.stiffness_n_per_m = std::max(
        worst.stiffness_n_per_m, Symmetric(k.topLeftCorner<3, 3>()).eigenvalues()(2));
    worst.stiffness_n_m_per_rad =
        std::max(worst.stiffness_n_m_per_rad,
                 Symmetric(k.bottomRightCorner<3, 3>()).eigenvalues()(2));
  }
  return worst;
}

std::string why_not_renderable(const WrenchMargin& margin, double linear_n_s_per_m,
                               double angular_n_m_s) {
  if (margin.share <= 1.0) {
    return {};
  }
  const std::string turning =
      angular_n_m_s > 0.0 ? fmt::format(" and {:.3g} N m/rad against {:.3g} N m s",
                                        margin.stiffness_n_m_per_rad, angular_n_m_s)
                          : std::string();
  return fmt::format(
      "the contacts together are {:.4g} N/m stiff against a damping of {:.3g} N s/m{}, "
      "{:.3g} times what it allows, mostly in {}",
      margin.stiffness_n_per_m, linear_n_s_per_m, turning, margin.share,
      margin.angular_share > 0.5 ? "turning" : "pressing");
}

}  // namespace palpate
