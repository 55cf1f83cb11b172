#include "precompute/material.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>
namespace palpate {
using M3 = Eigen::Matrix3d;
using V9 = Eigen::Matrix<double, 9, 1>;
static V9 vec(const M3& A) {
  return Eigen::Map<const V9>(A.data());
}
static M3 cof(const M3& F) {
  M3 c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}
static Tangent dcof(const M3& F) {
  // d cof(F)_{iI}/dF_{jJ} = eps_ijk eps_IJK F_kK
  Tangent T = Tangent::Zero();
  auto eps = [](int a, int b, int c) {
    return 0.5 * (a - b) * (b - c) * (c - a);
  };
  for (int i = 0; i < 3; i++) {
    for (int I = 0; I < 3; I++) {
      for (int j = 0; j < 3; j++) {
        for (int J = 0; J < 3; J++) {
          if (i == j || I == J) {
            continue;
          }
          int k = 3 - i - j, K = 3 - I - J;
          T(3 * I + i, 3 * J + j) = eps(i, j, k) * eps(I, J, K) * F(k, K);
        }
      }
    }
  }
  return T;
}
Linear linear(double E, double nu) {
  return {E / 2 / (1 + nu), E * nu / (1 + nu) / (1 - 2 * nu)};
}
NeoHookean neo_hookean(double E, double nu) {
  return {E / 2 / (1 + nu), E / 3 / (1 - 2 * nu)};
}
bool is_linear(const Material& m) {
  return m.index() == 0;
}
double volume_modulus_pa(const Material& m) {
  return m.index() == 0 ? std::get<0>(m).lambda : std::get<1>(m).k;
}
VolumeMeasure volume_measure(const Material& m) {
  return m.index() == 0 ? VolumeMeasure::kSmallTrace : VolumeMeasure::kJacobian;
}
double volume_theta(VolumeMeasure v, const M3& F) {
  return v == VolumeMeasure::kSmallTrace ? F.trace() - 3 : F.determinant() - 1;
}
VolumeResponse volume_response(VolumeMeasure v, const M3& F) {
  if (v == VolumeMeasure::kSmallTrace)
    return {F.trace() - 3, M3::Identity(), Tangent::Zero()};
  return {F.determinant() - 1, cof(F), dcof(F)};
}
double distortion_energy(const Material& m, const M3& F) {
  if (m.index() == 0) {
    auto& l = std::get<0>(m);
    M3 e = 0.5 * (F + F.transpose()) - M3::Identity();
    return l.mu * e.squaredNorm();
  }
  auto& n = std::get<1>(m);
  double J = F.determinant();
  if (!(J > 0))
    return std::numeric_limits<double>::infinity();
  return 0.5 * n.mu * (std::pow(J, -2. / 3) * F.squaredNorm() - 3);
}
LocalResponse distortion_response(const Material& m, const M3& F) {
  LocalResponse r;
  if (m.index() == 0) {
    auto& l = std::get<0>(m);
    M3 e = 0.5 * (F + F.transpose()) - M3::Identity();
    r.energy_density = l.mu * e.squaredNorm();
    r.stress = 2 * l.mu * e;
    r.tangent = l.mu * Tangent::Identity();
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j < 3; j++) {
        r.tangent(3 * j + i, 3 * i + j) += l.mu;
      }
    }
    return r;
  }
  auto& n = std::get<1>(m);
  double J = F.determinant();
  double a = std::pow(J, -2. / 3);
  double I1 = F.squaredNorm();
  M3 c = cof(F);
  r.energy_density = 0.5 * n.mu * (a * I1 - 3);
  r.stress = n.mu * a * (F - (I1 / (3 * J)) * c);
  V9 f = vec(F), g = vec(c) / J;
  Tangent T = Tangent::Identity();
  T -= (2. / 3) * (f * g.transpose() + g * f.transpose());
  T += (2. / 9 * I1 + I1 / 3) * g * g.transpose();
  T -= (I1 / (3 * J)) * dcof(F);
  r.tangent = n.mu * a * T;
  return r;
}
}  // namespace palpate
