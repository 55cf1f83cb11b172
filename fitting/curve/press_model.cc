#include "fitting/curve/press_model.h"

#include <algorithm>
#include <cmath>

#include "fitting/curve/quasi_linear.h"
#include "fitting/numerics/bounded_linear.h"

namespace palpate {
namespace {

constexpr double kStepMax = 0.02;    // [-] of the travel: a curve is straight over it
constexpr double kCloseNodes = 1.5;  // nodes are closer near the contact point
constexpr double kDifference = 1e-4;
constexpr double kRatioMax = 1e3;

double node_of(int j, int nodes, double contact) {
  return contact +
         (1.0 - contact) * std::pow(static_cast<double>(j) / (nodes - 1), kCloseNodes);
}

// Integral up to u of the hat over [left, top, right]; right not finite: a plateau.
double hat_integral(double u, double left, double top, double right) {
  double sum = 0.0;
  if (top > left) {
    const double s = std::clamp((u - left) / (top - left), 0.0, 1.0);
    sum += 0.5 * (top - left) * s * s;
  }
  if (std::isfinite(right)) {
    const double s = std::clamp((u - top) / (right - top), 0.0, 1.0);
    return sum + (right - top) * (s - 0.5 * s * s);
  }
  return sum + std::max(0.0, u - top);
}

}  // namespace

PressModel::PressModel(const PressSamples& samples, const Shape& shape)
    : shape_(shape), force_(samples.force), weight_(samples.weight) {
  std::vector<double> t, u;
  for (Eigen::Index i = 0; i < samples.depth.size(); ++i) {
    const double step = i > 0 ? samples.depth[i] - samples.depth[i - 1] : 0.0;
    // Steps of more than kStepMax are cut, evenly in time and depth: the convolution
    // takes the elastic force for straight between rows.
    const int parts =
        std::clamp(static_cast<int>(std::abs(step) / kStepMax) + 1, 1, 64);
    for (int k = 1; k <= parts && i > 0; ++k) {
      const double back = 1.0 - static_cast<double>(k) / parts;
      t.push_back(samples.time_s[i] -
                  back * (samples.time_s[i] - samples.time_s[i - 1]));
      u.push_back(samples.depth[i] - back * step);
    }
    if (i == 0) {
      t.push_back(samples.time_s[0]);
      u.push_back(samples.depth[0]);
    }
    sample_row_.push_back(std::ssize(t) - 1);
  }
  time_s_ = Eigen::Map<const Eigen::VectorXd>(t.data(), std::ssize(t));
  depth_ = Eigen::Map<const Eigen::VectorXd>(u.data(), std::ssize(u));
}

Eigen::MatrixXd PressModel::basis(const Eigen::VectorXd& depth, double contact,
                                  double exponent) const {
  Eigen::MatrixXd columns(depth.size(), coefficients());
  // Power law <u - contact>^exponent, or integrals of hats: with coefficients that are
  // not negative their sum rises, with a continuous slope.
  if (shape_.nodes == 0) {
    columns.col(0) = (depth.array() - contact).max(0.0).pow(exponent);
    return columns;
  }
  for (int j = 0; j < shape_.nodes; ++j) {
    const double top = node_of(j, shape_.nodes, contact);
    const double left = j > 0 ? node_of(j - 1, shape_.nodes, contact) : top;
    const double right =
        j + 1 < shape_.nodes ? node_of(j + 1, shape_.nodes, contact) : kInf;
    for (Eigen::Index i = 0; i < depth.size(); ++i) {
      columns(i, j) = hat_integral(depth[i], left, top, right);
    }
  }
  return columns;
}

// Derivatives of a by the contact point and, of a power law, by the exponent.
Eigen::MatrixXd PressModel::curve_slopes(const Eigen::VectorXd& q,
                                         const Eigen::VectorXd& depth) const {
  const double contact = q[contact_at()];
  Eigen::MatrixXd slopes(depth.size(), ratio_at() - contact_at());
  if (shape_.nodes > 0) {
    const auto c = q.segment(1, coefficients());
    slopes.col(0) = (basis(depth, contact + kDifference, 0.0) * c -
                     basis(depth, contact - kDifference, 0.0) * c) /
                    (2.0 * kDifference);
    return slopes;
  }
  const double c = q[1], p = q[contact_at() + 1];
  for (Eigen::Index i = 0; i < depth.size(); ++i) {
    const double d = depth[i] - contact;
    slopes(i, 0) = d > 0.0 ? -c * p * std::pow(d, p - 1.0) : 0.0;
    slopes(i, 1) = d > 0.0 ? c * std::pow(d, p) * std::log(d) : 0.0;
  }
  return slopes;
}

Eigen::MatrixXd PressModel::at_samples(const Eigen::MatrixXd& fine) const {
  return fine(sample_row_, Eigen::all);
}

void PressModel::evaluate(const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                          RowMajorMatrix* jacobian) const {
  // f = q0 + a + sum_k r_k (a - q_k), a(u) the slow force and q_k its relaxed part
  // (quasi_linear.h). r_k is the ratio of term k to what stays.
  const Eigen::Index J = coefficients();
  const double exponent = shape_.nodes == 0 ? q[contact_at() + 1] : 0.0;
  const bool wanted = jacobian != nullptr;
  // The curve, then what its derivatives need: each signal goes through T.
  const Eigen::MatrixXd phi = basis(depth_, q[contact_at()], exponent);
  Eigen::MatrixXd signals(depth_.size(), wanted ? ratio_at() : 1);
  signals.col(0) = phi * q.segment(1, J);
  if (wanted) {
    signals.middleCols(1, J) = phi;
    signals.rightCols(ratio_at() - 1 - J) = curve_slopes(q, depth_);
  }
  Eigen::MatrixXd through = signals;
  for (Eigen::Index k = 0; k < shape_.terms; ++k) {
    const double ratio = q[ratio_at() + k], tau = std::exp(q[tau_at() + k]);
    const Eigen::MatrixXd kept = signals - relaxed_force(time_s_, signals, tau);
    through += ratio * kept;
    if (wanted) {
      jacobian->col(ratio_at() + k) = at_samples(kept.col(0));
      const Eigen::MatrixXd a = signals.col(0);
      // By ln tau: a central difference, -r_k dq_k / dln tau.
      jacobian->col(tau_at() + k) =
          at_samples(relaxed_force(time_s_, a, tau * std::exp(-kDifference)) -
                     relaxed_force(time_s_, a, tau * std::exp(kDifference))) *
          (ratio / (2.0 * kDifference));
    }
  }
  const Eigen::MatrixXd rows = at_samples(through);
  r = weight_.cwiseProduct((rows.col(0).array() + q[0]).matrix() - force_);
  if (wanted) {
    jacobian->col(0).setOnes();
    jacobian->middleCols(1, ratio_at() - 1) = rows.rightCols(ratio_at() - 1);
    jacobian->array().colwise() *= weight_.array();
  }
}

LeastSquaresProblem PressModel::problem() const {
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(force_.size());
  problem.in_a_row = problem.residuals;
  problem.lower = Eigen::VectorXd::Zero(parameters());
  problem.upper = Eigen::VectorXd::Constant(parameters(), kInf);
  problem.lower[0] = -kInf;
  problem.upper[contact_at()] = shape_.contact_max;
  if (shape_.nodes == 0) {
    problem.lower[contact_at() + 1] = 0.5;
    problem.upper[contact_at() + 1] = 6.0;
  }
  problem.upper.segment(ratio_at(), shape_.terms).setConstant(kRatioMax);
  problem.lower.tail(shape_.terms).setConstant(std::log(shape_.tau_min_s));
  problem.upper.tail(shape_.terms).setConstant(std::log(shape_.tau_max_s));
  problem.evaluate = [this](const Eigen::VectorXd& q,
                            const Eigen::Ref<Eigen::VectorXd>& r,
                            RowMajorMatrix* jacobian) {
    evaluate(q, r, jacobian);
    return r.allFinite();
  };
  return problem;
}

Eigen::VectorXd PressModel::start(double contact, double exponent,
                                  const Eigen::VectorXd& ratio,
                                  const Eigen::VectorXd& tau_s) const {
  Eigen::VectorXd q(parameters());
  const Eigen::MatrixXd phi = basis(depth_, contact, exponent);
  Eigen::MatrixXd through = phi;
  for (Eigen::Index k = 0; k < shape_.terms; ++k) {
    through += ratio[k] * (phi - relaxed_force(time_s_, phi, tau_s[k]));
  }
  // At given contact point, exponent and terms the model is linear in the baseline and
  // the curve's coefficients.
  Eigen::MatrixXd columns(force_.size(), 1 + phi.cols());
  columns << Eigen::VectorXd::Ones(force_.size()), at_samples(through);
  columns.array().colwise() *= weight_.array();
  std::vector<bool> rising(static_cast<std::size_t>(columns.cols()), true);
  rising[0] = false;
  q.head(columns.cols()) =
      solve_not_negative(columns, weight_.cwiseProduct(force_), rising);
  q[contact_at()] = contact;
  if (shape_.nodes == 0) {
    q[contact_at() + 1] = exponent;
  }
  q.segment(ratio_at(), shape_.terms) = ratio;
  q.tail(shape_.terms) = tau_s.array().log();
  return q;
}

Eigen::VectorXd PressModel::instantaneous(const Eigen::VectorXd& q,
                                          const Eigen::VectorXd& depth,
                                          Eigen::MatrixXd* jacobian) const {
  const double exponent = shape_.nodes == 0 ? q[contact_at() + 1] : 0.0;
  const Eigen::MatrixXd phi = basis(depth, q[contact_at()], exponent);
  const Eigen::VectorXd slow = phi * q.segment(1, coefficients());
  // A sudden press has relaxed nothing: f = (1 + sum r_k) a.
  const double times = 1.0 + q.segment(ratio_at(), shape_.terms).sum();
  if (jacobian != nullptr) {
    jacobian->setZero(depth.size(), parameters());
    jacobian->middleCols(1, coefficients()) = times * phi;
    jacobian->middleCols(contact_at(), ratio_at() - contact_at()) =
        times * curve_slopes(q, depth);
    jacobian->middleCols(ratio_at(), shape_.terms).colwise() = slow;
  }
  return times * slow;
}

}  // namespace palpate
