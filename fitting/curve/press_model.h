// The force of a whole press and hold, as a function of an instantaneous curve and
// terms of relaxation:
//
//   F(t) = b + T a(t),  a(t) = g_inf f_e(d(t)),  T a = a + sum_k r_k (a - q_k[a])
//
// q_k[a] what has relaxed (quasi_linear.h), r_k = g_k / g_inf >= 0, so that any r gives
// g_k = r_k / (1 + sum r) and their sum stays below 1. b [N] baseline. All but time is
// scaled: depths by the travel, forces by the largest.
//
// Curves: the power law a = c max(u - u0, 0)^p, and the monotone spline a = sum_j c_j
// phi_j(u). The spline's c_j >= 0 are its slopes at nodes from the contact point u0 on,
// straight between them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "fitting/numerics/least_squares.h"

namespace palpate {

struct PressSamples {
  Eigen::VectorXd time_s;  ///< (n) [s] not falling
  Eigen::VectorXd depth;   ///< (n) [-] over the travel, 0 at the shallowest
  Eigen::VectorXd force;   ///< (n) [-] over the largest
  Eigen::VectorXd
      weight;  ///< (n) [-] of a residual: 1 / standard deviation, in proportion
};

/// Parameters q: b, the curve's coefficients c (one, or one a node), u0, of a power law
/// p, r_k, ln tau_k.
class PressModel {
 public:
  struct Shape {
    int nodes = 0;             ///< of the spline, at least 2; 0: the power law
    int terms = 2;             ///< of relaxation
    double contact_max = 0.9;  ///< [-] the largest u0
    double tau_min_s = 0.0, tau_max_s = 0.0;  ///< [s] bounds of the times
  };

  PressModel(const PressSamples& samples, const Shape& shape);

  /// Residuals, derivatives and bounds; refers to this object.
  [[nodiscard]] LeastSquaresProblem problem() const;

  /// Coefficients and baseline that fit best to a given contact point, exponent, r and
  /// tau (k), as a start. @param exponent is not used by a spline.
  [[nodiscard]] Eigen::VectorXd start(double contact, double exponent,
                                      const Eigen::VectorXd& ratio,
                                      const Eigen::VectorXd& tau_s) const;

  /// f_e(u) without baseline at depths u (m), and its derivatives (m x p) where that is
  /// not null.
  [[nodiscard]] Eigen::VectorXd instantaneous(const Eigen::VectorXd& q,
                                              const Eigen::VectorXd& depth,
                                              Eigen::MatrixXd* jacobian) const;

  [[nodiscard]] Eigen::Index parameters() const { return tau_at() + shape_.terms; }
  [[nodiscard]] Eigen::Index contact_at() const { return 1 + coefficients(); }
  [[nodiscard]] Eigen::Index ratio_at() const {
    return contact_at() + (shape_.nodes == 0 ? 2 : 1);
  }
  [[nodiscard]] Eigen::Index tau_at() const { return ratio_at() + shape_.terms; }
  [[nodiscard]] const Shape& shape() const { return shape_; }

 private:
  [[nodiscard]] Eigen::Index coefficients() const {
    return shape_.nodes == 0 ? 1 : shape_.nodes;
  }
  [[nodiscard]] Eigen::MatrixXd basis(const Eigen::VectorXd& depth, double contact,
                                      double exponent) const;
  [[nodiscard]] Eigen::MatrixXd curve_slopes(const Eigen::VectorXd& q,
                                             const Eigen::VectorXd& depth) const;
  [[nodiscard]] Eigen::MatrixXd at_samples(const Eigen::MatrixXd& fine) const;
  void evaluate(const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                RowMajorMatrix* jacobian) const;

  Shape shape_;
  Eigen::VectorXd force_, weight_;        // (n) of the samples
  Eigen::VectorXd time_s_, depth_;        // (m >= n) with steps between them
  std::vector<Eigen::Index> sample_row_;  // (n) of the above
};

}  // namespace palpate
