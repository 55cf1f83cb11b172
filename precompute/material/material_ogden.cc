#include "precompute/material/material_ogden.h"

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "precompute/material/material_check.h"
#include "precompute/material/strain_invariants.h"

namespace palpate {
namespace {

// F = sum_a stretch_a n_a N_a'.
struct PrincipalFrame {
  Eigen::Vector3d stretch;  // l_a
  Eigen::Vector3d log_bar;  // log lbar_a; the sum is zero
  Eigen::Matrix3d N;        // columns N_a
  Eigen::Matrix3d n;        // columns n_a
};

// Nothing where det F <= 0. The eigenvalues are those of F'F - 1, so that log_bar keeps
// its digits at small strain.
std::optional<PrincipalFrame> principal_frame(const Eigen::Matrix3d& F) {
  if (!(F.determinant() > 0.0)) {
    return std::nullopt;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(twice_green_strain(F));
  const Eigen::Vector3d& d = solver.eigenvalues();
  if (!(d[0] > -1.0)) {
    return std::nullopt;
  }
  const Eigen::Vector3d log_stretch =
      0.5 * Eigen::Vector3d(reproducible::log1p(d[0]), reproducible::log1p(d[1]),
                            reproducible::log1p(d[2]));
  PrincipalFrame frame;
  frame.stretch = (1.0 + d.array()).sqrt();
  frame.log_bar = log_stretch.array() - log_stretch.mean();
  frame.N = solver.eigenvectors();
  frame.n = F * frame.N * frame.stretch.cwiseInverse().asDiagonal();
  return frame;
}

double energy_in(const Ogden& law, const PrincipalFrame& frame) {
  // sum_i mu_i / alpha_i sum_a (lbar_a^alpha_i - 1), lbar^alpha = exp(alpha log lbar).
  double energy = 0.0;
  for (std::size_t i = 0; i < law.n_terms; ++i) {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      sum += reproducible::expm1(law.alpha[i] * frame.log_bar[a]);
    }
    energy += law.mu_pa[i] / law.alpha[i] * sum;
  }
  return finite_or_infinite(energy);
}

// (x^p - y^p) y^(1 - p) / (x - y) with log(x/y) = L; p where x = y. No cancellation for
// any L, so that equal and nearly equal stretches need no series.
double power_slope(double p, double L) {
  return L == 0.0 ? p : reproducible::expm1(p * L) / reproducible::expm1(L);
}

// Derivatives of Psi by the stretches, and what they give for rotations of the frame.
struct PrincipalDerivatives {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();   // W_a
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  // W_ab
  Eigen::Vector3d flip = Eigen::Vector3d::Zero();       // (W_a - W_b)/(l_a - l_b)
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();      // (W_a + W_b)/(l_a + l_b)
};

constexpr std::array<std::array<int, 2>, 3> kPairs{{{0, 1}, {1, 2}, {2, 0}}};

// With q_a = lbar_a^alpha, m = mean q: l_a W_a = mu (q_a - m),
// d(l_a W_a)/d log l_b = mu alpha (q_a [a = b] - (q_a + q_b - m)/3).
void add_term(double mu, double alpha, const PrincipalFrame& frame,
              PrincipalDerivatives& W) {
  const Eigen::Vector3d& l = frame.stretch;
  const Eigen::Vector3d q(reproducible::exp(alpha * frame.log_bar[0]),
                          reproducible::exp(alpha * frame.log_bar[1]),
                          reproducible::exp(alpha * frame.log_bar[2]));
  const double m = q.mean();
  for (int a = 0; a < 3; ++a) {
    W.gradient[a] += mu * (q[a] - m) / l[a];
    for (int b = 0; b < 3; ++b) {
      const double scaled = alpha * ((a == b ? q[a] : 0.0) - (q[a] + q[b] - m) / 3.0) -
                            (a == b ? q[a] - m : 0.0);
      W.curvature(a, b) += mu * scaled / (l[a] * l[b]);
    }
  }
  // (W_a - W_b)/(l_a - l_b) = mu ((q_a/l_a - q_b/l_b)/(l_a - l_b) + m/(l_a l_b)). The
  // first term is q_b/l_b^2 times power_slope of p = alpha - 1.
  for (int pair = 0; pair < 3; ++pair) {
    const auto [a, b] = kPairs[static_cast<std::size_t>(pair)];
    const double slope = power_slope(alpha - 1.0, frame.log_bar[a] - frame.log_bar[b]);
    W.flip[pair] += mu * (q[b] / (l[b] * l[b]) * slope + m / (l[a] * l[b]));
  }
}

// The tangent's eigenvectors outside the diagonal are flips (n_a N_b + n_b N_a)/sqrt 2
// and twists (n_a N_b - n_b N_a)/sqrt 2.
Tangent assembled_tangent(const PrincipalFrame& frame, const PrincipalDerivatives& W) {
  Tangent basis;
  const auto set_column = [&basis](int column, const Eigen::Matrix3d& tensor) {
    basis.col(column) = as_vector(tensor);
  };
  for (int a = 0; a < 3; ++a) {
    set_column(a, frame.n.col(a) * frame.N.col(a).transpose());
    const auto [b, c] = kPairs[static_cast<std::size_t>(a)];
    const Eigen::Matrix3d bc = frame.n.col(b) * frame.N.col(c).transpose();
    const Eigen::Matrix3d cb = frame.n.col(c) * frame.N.col(b).transpose();
    set_column(3 + a, std::sqrt(0.5) * (bc + cb));
    set_column(6 + a, std::sqrt(0.5) * (bc - cb));
  }
  // A = B D B^T with B = `basis`. D is W_ab among the stretches and diagonal elsewhere:
  // the flips' and twists' eigenvalues.
  Tangent scaled;
  scaled.leftCols<3>().noalias() = basis.leftCols<3>() * W.curvature;
  scaled.middleCols<3>(3).noalias() = basis.middleCols<3>(3) * W.flip.asDiagonal();
  scaled.rightCols<3>().noalias() = basis.rightCols<3>() * W.twist.asDiagonal();
  return scaled.lazyProduct(basis.transpose());
}

}  // namespace

Ogden ogden(std::span<const double> mu_pa, std::span<const double> alpha,
            double poissons_ratio) {
  if (mu_pa.empty() || mu_pa.size() > Ogden::kMaxTerms ||
      mu_pa.size() != alpha.size()) {
    throw InputError(
        fmt::format("Ogden's law has {} moduli and {} exponents; must be as many "
                    "of both, 1 to {}",
                    mu_pa.size(), alpha.size(), Ogden::kMaxTerms));
  }
  check_poissons_ratio(poissons_ratio);
  Ogden law;
  law.n_terms = mu_pa.size();
  // Shear modulus at rest: half of sum_i mu_i alpha_i [Pa].
  double twice_shear_pa = 0.0;
  for (std::size_t i = 0; i < law.n_terms; ++i) {
    if (!std::isfinite(mu_pa[i]) || !std::isfinite(alpha[i]) || alpha[i] == 0.0) {
      throw InputError(
          fmt::format("term {} of Ogden's law has modulus {} Pa and exponent {}; "
                      "must be finite, the exponent not 0",
                      i + 1, mu_pa[i], alpha[i]));
    }
    law.mu_pa[i] = mu_pa[i];
    law.alpha[i] = alpha[i];
    twice_shear_pa += mu_pa[i] * alpha[i];
  }
  check_positive_pa("Ogden's shear modulus, half the sum of modulus times exponent,",
                    0.5 * twice_shear_pa);
  law.bulk_modulus_pa = bulk_modulus_from(0.5 * twice_shear_pa, poissons_ratio);
  return law;
}

double distortion_energy(const Ogden& law, const Eigen::Matrix3d& F) {
  const auto frame = principal_frame(F);
  return frame ? energy_in(law, *frame) : std::numeric_limits<double>::infinity();
}

LocalResponse distortion_response(const Ogden& law, const Eigen::Matrix3d& F) {
  const auto frame = principal_frame(F);
  if (!frame) {
    return inadmissible();
  }
  // P = sum_a W_a n_a N_a^T, W_a = dPsi/dl_a.
  PrincipalDerivatives W;
  for (std::size_t i = 0; i < law.n_terms; ++i) {
    add_term(law.mu_pa[i], law.alpha[i], *frame, W);
  }
  for (int pair = 0; pair < 3; ++pair) {
    const auto [a, b] = kPairs[static_cast<std::size_t>(pair)];
    W.twist[pair] =
        (W.gradient[a] + W.gradient[b]) / (frame->stretch[a] + frame->stretch[b]);
  }
  LocalResponse response{energy_in(law, *frame),
                         frame->n * W.gradient.asDiagonal() * frame->N.transpose(),
                         assembled_tangent(*frame, W)};
  return std::isfinite(response.energy_density) ? response : inadmissible();
}

VolumeTerm volume_term(const Ogden& law) {
  return {VolumeMeasure::kJacobian, law.bulk_modulus_pa};
}

SmallStrainModuli small_strain_moduli(const Ogden& law) {
  double twice_shear_pa = 0.0;
  for (std::size_t i = 0; i < law.n_terms; ++i) {
    twice_shear_pa += law.mu_pa[i] * law.alpha[i];
  }
  return {0.5 * twice_shear_pa, law.bulk_modulus_pa};
}

}  // namespace palpate
