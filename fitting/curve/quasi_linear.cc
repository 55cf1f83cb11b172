#include "fitting/curve/quasi_linear.h"

#include <cmath>

namespace palpate {

Eigen::MatrixXd relaxed_force(const Eigen::VectorXd& time_s,
                              const Eigen::MatrixXd& elastic, double tau_s) {
  const Eigen::Index n = elastic.rows();
  // int of exp(-(t_i - s) / tau) e(s) ds / tau over a step, e(s) linear.
  Eigen::VectorXd left(n), before(n), after(n);
  double step = -1.0;
  for (Eigen::Index i = 1; i < n; ++i) {
    const double h = time_s[i] - time_s[i - 1];
    if (h == step) {
      left[i] = left[i - 1], before[i] = before[i - 1], after[i] = after[i - 1];
      continue;
    }
    step = h;
    const double x = h / tau_s;
    left[i] = std::exp(-x);
    const double mean = x > 0.0 ? -std::expm1(-x) / x : 1.0;
    before[i] = mean - left[i];
    after[i] = 1.0 - mean;
  }
  Eigen::MatrixXd q(n, elastic.cols());
  for (Eigen::Index c = 0; c < q.cols(); ++c) {
    const double* e = elastic.col(c).data();
    double* out = q.col(c).data();
    out[0] = e[0];
    for (Eigen::Index i = 1; i < n; ++i) {
      out[i] = left[i] * out[i - 1] + before[i] * e[i - 1] + after[i] * e[i];
    }
  }
  return q;
}

std::vector<RelaxationTerm> shown_by_press(std::span<const RelaxationTerm> terms,
                                           std::span<const double> displacement_m,
                                           std::span<const double> force_n,
                                           double speed_m_per_s) {
  const auto n = std::ssize(force_n);
  const Eigen::VectorXd time_s =
      Eigen::Map<const Eigen::VectorXd>(displacement_m.data(), n) / speed_m_per_s;
  const Eigen::VectorXd elastic = Eigen::Map<const Eigen::VectorXd>(force_n.data(), n);
  std::vector<RelaxationTerm> shown(terms.begin(), terms.end());
  double force = elastic[n - 1];
  for (RelaxationTerm& term : shown) {
    const double relaxed = relaxed_force(time_s, elastic, term.tau_s)(n - 1, 0);
    force -= term.g * relaxed;
    term.g *= elastic[n - 1] - relaxed;
  }
  for (RelaxationTerm& term : shown) {
    const double share = term.g / force;
    term.g_sd = 0.0;  // of the instantaneous term, not of this one
    term.g = share;
  }
  return shown;
}

}  // namespace palpate
