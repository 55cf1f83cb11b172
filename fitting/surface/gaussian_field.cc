#include "fitting/surface/gaussian_field.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

double kappa2_per_m2(const FieldParameters& p) {
  return 2.0 * p.smoothness / (p.length_m * p.length_m);
}

// s of the precision, so that a plane's variance is sd^2.
double precision_scale(const FieldParameters& p) {
  return 1.0 / (4.0 * std::numbers::pi * p.smoothness *
                std::pow(kappa2_per_m2(p), p.smoothness) * p.sd * p.sd);
}

double log_determinant(const SparseFactor& factor) {
  const auto& lower = factor.matrixL().nestedExpression();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < lower.cols(); ++i) {
    sum += 2.0 * std::log(lower.valuePtr()[lower.outerIndexPtr()[i]]);
  }
  return sum;
}

void check(const FieldParameters& p) {
  if (!(p.length_m > 0.0) || !(p.sd > 0.0) || !(p.nugget_sd >= 0.0) ||
      !std::isfinite(p.length_m + p.sd + p.nugget_sd) ||
      (p.smoothness != 1 && p.smoothness != 2)) {
    throw InputError(
        fmt::format("field parameters: length {} m and sd {} must be positive, nugget "
                    "{} must not be negative, smoothness {} must be 1 or 2",
                    p.length_m, p.sd, p.nugget_sd, p.smoothness));
  }
}

// Weights D of the data; 0 where not used.
Eigen::VectorXd data_precision(const FieldParameters& p, const FieldData& data,
                               Eigen::Index m) {
  if (data.value.size() != m || data.sd.size() != m ||
      std::ssize(data.used) != static_cast<std::ptrdiff_t>(m)) {
    throw InputError(
        fmt::format("field data: {} values, {} errors and {} marks for {} points",
                    data.value.size(), data.sd.size(), data.used.size(), m));
  }
  Eigen::VectorXd D = Eigen::VectorXd::Zero(m);
  Eigen::Index used = 0;
  for (Eigen::Index i = 0; i < m; ++i) {
    if (data.used[static_cast<std::size_t>(i)] == 0) {
      continue;
    }
    // Variance of a datum: its stated error, and the nugget beyond that.
    const double variance = data.sd[i] * data.sd[i] + p.nugget_sd * p.nugget_sd;
    if (!std::isfinite(data.value[i]) || !(data.sd[i] >= 0.0) || !(variance > 0.0) ||
        !std::isfinite(variance)) {
      throw InputError(
          fmt::format("field data: point {} has value {} and error {}, nugget {}: the "
                      "error must be positive and both finite",
                      i, data.value[i], data.sd[i], p.nugget_sd));
    }
    D[i] = 1.0 / variance;
    ++used;
  }
  if (used < 2) {
    throw InputError(fmt::format(
        "field data: {} of {} points are used, at least 2 are needed", used, m));
  }
  return D;
}

// (n) mean squared length of the edges at a vertex, over 16 [m^2].
Eigen::VectorXd sag_m2(const SurfaceMesh& mesh) {
  const Eigen::Index n = mesh.position_m.rows();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(n);
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      const std::int32_t a = mesh.triangle(t, c);
      const std::int32_t b = mesh.triangle(t, (c + 1) % 3);
      const double squared =
          (mesh.position_m.row(a) - mesh.position_m.row(b)).squaredNorm();
      for (const std::int32_t v : {a, b}) {
        sum[v] += squared;
        count[v] += 1.0;
      }
    }
  }
  return sum.cwiseQuotient(16.0 * count);
}

}  // namespace

// The data's part of the algebra, shared by likelihood and posterior.
struct FieldModel::Conditioned {
  Eigen::VectorXd D;                     // (m)
  const SparseFactor* factor = nullptr;  // of Q + A^T D A
  Eigen::VectorXd one_node, value_node;  // (n) its inverse times A^T D 1, A^T D y
  Eigen::VectorXd one, value;            // (m) V^-1 1, V^-1 y
  double precision = 0.0;                // 1^T V^-1 1
  double mean = 0.0;                     // mu
  double log_likelihood = 0.0;
};

FieldModel::FieldModel(const SurfaceMesh& mesh, std::vector<AttachedPoint> point)
    : mesh_(mesh),
      point_(std::move(point)),
      operator_(surface_operator(mesh)),
      sag_m2_(sag_m2(mesh)) {
  const Eigen::VectorXd inverse_mass = operator_.mass_m2.cwiseInverse();
  power_[0] = SparseSquare(operator_.mass_m2.asDiagonal());
  power_[1] = operator_.stiffness;
  power_[2] = power_[1] * inverse_mass.asDiagonal() * power_[1];
  power_[3] = power_[2] * inverse_mass.asDiagonal() * power_[1];
  // A: a row of area coordinates for each point.
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < point_.size(); ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      entries.emplace_back(static_cast<int>(i), mesh_.triangle(point_[i].triangle, c),
                           point_[i].weight[c]);
    }
  }
  attachment_.resize(std::ssize(point_), mesh_.position_m.rows());
  attachment_.setFromTriplets(entries.begin(), entries.end());
}

void FieldModel::factorise(Factor& factor, const SparseSquare& matrix,
                           const FieldParameters& p) const {
  if (!factor.analysed) {
    factor.factor.analyzePattern(matrix);
    factor.analysed = true;
  }
  factor.factor.factorize(matrix);
  if (factor.factor.info() != Eigen::Success) {
    throw NumericalError(
        fmt::format("field on the surface: the precision is not positive definite at "
                    "length {:.3g} m, sd {:.3g}, nugget {:.3g}",
                    p.length_m, p.sd, p.nugget_sd));
  }
}

SparseSquare FieldModel::prior_precision(const FieldParameters& parameters) const {
  check(parameters);
  const double k2 = kappa2_per_m2(parameters);
  const double s = precision_scale(parameters);
  // Q = s (k2 C + G) [C^-1 (k2 C + G)]^nu (Lindgren, Rue, Lindstrom 2011), C the lumped
  // mass, G the stiffness, nu = smoothness. power_[i] = G (C^-1 G)^(i - 1), power_[0] =
  // C.
  if (parameters.smoothness == 1) {
    return (s * k2 * k2) * power_[0] + (2.0 * s * k2) * power_[1] + s * power_[2];
  }
  return SparseSquare((s * k2 * k2 * k2) * power_[0] + (3.0 * s * k2 * k2) * power_[1] +
                      (3.0 * s * k2) * power_[2]) +
         s * power_[3];
}

double FieldModel::prior_log_determinant(const FieldParameters& parameters) const {
  if (last_prior_ && last_prior_->first.length_m == parameters.length_m &&
      last_prior_->first.sd == parameters.sd &&
      last_prior_->first.smoothness == parameters.smoothness) {
    return last_prior_->second;
  }
  factorise(elliptic_factor_, kappa2_per_m2(parameters) * power_[0] + power_[1],
            parameters);
  // ln|Q| = n ln s + alpha ln|k2 C + G| - (alpha - 1) ln|C|, alpha = nu + 1.
  const double alpha = parameters.smoothness + 1.0;
  const double value = alpha * log_determinant(elliptic_factor_.factor) -
                       (alpha - 1.0) * operator_.mass_m2.array().log().sum() +
                       static_cast<double>(operator_.mass_m2.size()) *
                           std::log(precision_scale(parameters));
  last_prior_ = {parameters, value};
  return value;
}

FieldModel::Conditioned FieldModel::condition(const FieldParameters& parameters,
                                              const FieldData& data) const {
  check(parameters);
  Conditioned c;
  c.D = data_precision(parameters, data, attachment_.rows());
  const auto& A = attachment_;
  const SparseSquare weighted = A.transpose() * c.D.asDiagonal() * A;
  Factor& factor =
      posterior_factor_[static_cast<std::size_t>(parameters.smoothness - 1)];
  factorise(factor, prior_precision(parameters) + weighted, parameters);
  c.factor = &factor.factor;
  const Eigen::VectorXd y = (c.D.array() > 0.0).select(data.value, 0.0);
  // V = A Q^-1 A^T + D^-1 of the data. V^-1 = D - D A (Q + A^T D A)^-1 A^T D
  // (Woodbury).
  c.one_node = c.factor->solve(A.transpose() * c.D);
  c.value_node = c.factor->solve(A.transpose() * c.D.cwiseProduct(y));
  c.one = c.D - c.D.cwiseProduct(A * c.one_node);
  c.value = c.D.cwiseProduct(y - A * c.value_node);
  c.precision = c.one.sum();
  // mu = 1^T V^-1 y / 1^T V^-1 1, squares = (y - mu)^T V^-1 (y - mu).
  c.mean = c.value.sum() / c.precision;
  const double squares = y.dot(c.value) - c.mean * c.value.sum();
  double log_D = 0.0;
  double used = 0.0;
  for (const double d : c.D) {
    log_D += d > 0.0 ? std::log(d) : 0.0;
    used += d > 0.0 ? 1.0 : 0.0;
  }
  // Restricted likelihood: ln|V| = ln|Q + A^T D A| - ln|Q| - ln|D|, and ln(1^T V^-1 1)
  // for mu.
  c.log_likelihood =
      -0.5 * (log_determinant(*c.factor) - prior_log_determinant(parameters) - log_D +
              std::log(c.precision) + squares +
              (used - 1.0) * std::log(2.0 * std::numbers::pi));
  return c;
}

double FieldModel::log_marginal_likelihood(const FieldParameters& parameters,
                                           const FieldData& data) const {
  return condition(parameters, data).log_likelihood;
}

double FieldModel::variance_at(const SelectedInverse& S, std::size_t point) const {
  const AttachedPoint& p = point_[point];
  double variance = 0.0;
  for (Eigen::Index a = 0; a < 3; ++a) {
    for (Eigen::Index b = 0; b < 3; ++b) {
      variance += p.weight[a] * p.weight[b] *
                  S.at(mesh_.triangle(p.triangle, a), mesh_.triangle(p.triangle, b));
    }
  }
  return variance;
}

void FieldModel::leave_out(const Conditioned& c, const SelectedInverse& S,
                           const FieldParameters& parameters, const FieldData& data,
                           FieldPosterior& result) const {
  const Eigen::VectorXd at_mean = attachment_ * result.mean;
  const Eigen::VectorXd at_loose = 1.0 - (attachment_ * c.one_node).array();
  const double nugget2 = parameters.nugget_sd * parameters.nugget_sd;
  for (Eigen::Index i = 0; i < attachment_.rows(); ++i) {
    if (!std::isfinite(data.value[i])) {
      continue;
    }
    const double variance = variance_at(S, static_cast<std::size_t>(i));
    if (c.D[i] > 0.0) {  // [P y]_i / P_ii and 1 / P_ii
      const double P_ii =
          c.D[i] - c.D[i] * c.D[i] * variance - c.one[i] * c.one[i] / c.precision;
      result.left_out_residual[i] = (c.value[i] - c.mean * c.one[i]) / P_ii;
      result.left_out_sd[i] = std::sqrt(1.0 / P_ii);
    } else {
      result.left_out_residual[i] = data.value[i] - at_mean[i];
      result.left_out_sd[i] =
          std::sqrt(variance + at_loose[i] * at_loose[i] / c.precision + nugget2 +
                    data.sd[i] * data.sd[i]);
    }
  }
}

FieldPosterior FieldModel::posterior(const FieldParameters& parameters,
                                     const FieldData& data) const {
  const Conditioned c = condition(parameters, data);
  const SelectedInverse S(*c.factor);
  FieldPosterior result;
  result.log_likelihood = c.log_likelihood;
  result.mean_level = c.mean;
  const Eigen::VectorXd x = c.value_node - c.mean * c.one_node;
  result.mean = x.array() + c.mean;
  // What mu's uncertainty adds goes with how little the data pin a node to themselves.
  const Eigen::VectorXd loose = 1.0 - c.one_node.array();
  result.sd =
      (S.diagonal().array() + loose.array().square() / c.precision).max(0.0).sqrt();
  result.sag = -sag_m2_.cwiseProduct(operator_.stiffness * result.mean)
                    .cwiseQuotient(operator_.mass_m2);
  result.left_out_residual.setConstant(attachment_.rows(),
                                       std::numeric_limits<double>::quiet_NaN());
  result.left_out_sd = result.left_out_residual;
  leave_out(c, S, parameters, data, result);
  return result;
}

}  // namespace palpate
