// A Gaussian process on a surface, in sparse form, conditioned on scattered data with
// errors of their own. The process gives log force of one depth from probes to every
// node.
//
// Prior (Lindgren, Rue and Lindstrom 2011, alpha = 2 or 3: Matern of smoothness
// nu = alpha - 1 in the plane), on linear elements:
//
//   value = mu + x,  x ~ N(0, Q^-1),  Q = s L (C^-1 L)^(alpha - 1),  L = kappa^2 C + G,
//   kappa = sqrt(2 nu) / length,  s = 1 / (4 pi nu kappa^(2 nu) sd^2),
//
// mu unknown with a flat prior. Data: y = mu + A x + e, e ~ N(0, D^-1), 1 / D_ii =
// sd_i^2 + nugget^2. Symbols: C lumped mass [m^2], G cotangent stiffness [-], A area
// coordinates of the data's points (m x n). On bodies smaller than a few lengths the
// prior's standard deviation differs from `sd`; likelihood and posterior use Q as is.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "fitting/numerics/selected_inverse.h"
#include "fitting/surface/attached_point.h"
#include "fitting/surface/laplace_beltrami.h"
#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct FieldParameters {
  double length_m = 0.0;   ///< [m] correlation falls to about 0.45 there
  double sd = 0.0;         ///< [-] of the field about its mean
  double nugget_sd = 0.0;  ///< [-] of data, beyond their stated errors
  int smoothness = 1;      ///< [-] nu, 1 or 2: what is smooth is known better
};

/// One value at each point of a model; points without one are not used.
struct FieldData {
  Eigen::VectorXd value;   ///< (m) [-] e.g. log of force over 1 N
  Eigen::VectorXd sd;      ///< (m) [-] stated standard error, >= 0
  std::vector<char> used;  ///< (m) whether the posterior may know it
};

struct FieldPosterior {
  double mean_level = 0.0;  ///< [-] mu, generalised least squares
  Eigen::VectorXd mean;     ///< (n) [-] of the linear field at the nodes
  Eigen::VectorXd sd;       ///< (n) [-] of it, mu's share included
  /// (n) [-] e^2 lap(mean) / 16, mean squared edge e^2. Where a field is curved, a
  /// linear field that fits it over the triangles lies so far below it at the nodes
  Eigen::VectorXd sag;
  [[nodiscard]] Eigen::VectorXd at_nodes() const {  ///< (n) [-] the field itself
    return mean + sag;
  }
  /// (m) [-] value minus its prediction from all other used data, in closed form (also
  /// for data that are not used). NaN where the value is not finite
  Eigen::VectorXd left_out_residual;
  /// (m) [-] standard deviation of that residual: field, error and nugget
  Eigen::VectorXd left_out_sd;
  double log_likelihood = 0.0;  ///< as log_marginal_likelihood()
};

/// Not safe for use from several threads at once: factorisations share their pattern.
class FieldModel {
 public:
  /// @throws InputError as surface_operator() does.
  FieldModel(const SurfaceMesh& mesh, std::vector<AttachedPoint> point);

  /// Log density of the used data, mu integrated out (restricted likelihood): -1/2
  ///   [log|V| + log(1^T V^-1 1) + y^T P y + (m - 1) log 2 pi]. V = A Q^-1 A^T + D^-1,
  ///   P = V^-1 - V^-1 1 1^T V^-1 / (1^T V^-1 1). The density is found by two sparse
  ///   factorisations: |V| = |Q + A^T D A| / (|Q| |D|).
  /// @throws InputError for parameters or data out of range, fewer than 2 used data;
  /// NumericalError if a factorisation fails.
  [[nodiscard]] double log_marginal_likelihood(const FieldParameters& parameters,
                                               const FieldData& data) const;

  /// Throws as log_marginal_likelihood() does.
  [[nodiscard]] FieldPosterior posterior(const FieldParameters& parameters,
                                         const FieldData& data) const;

  /// Q (n x n).
  [[nodiscard]] SparseSquare prior_precision(const FieldParameters& parameters) const;

  /// A (m x n).
  [[nodiscard]] const Eigen::SparseMatrix<double>& attachment() const {
    return attachment_;
  }
  [[nodiscard]] const std::vector<AttachedPoint>& point() const { return point_; }
  [[nodiscard]] const SurfaceMesh& mesh() const { return mesh_; }

 private:
  struct Conditioned;
  [[nodiscard]] Conditioned condition(const FieldParameters& parameters,
                                      const FieldData& data) const;
  [[nodiscard]] double variance_at(const SelectedInverse& S, std::size_t point) const;
  void leave_out(const Conditioned& c, const SelectedInverse& S,
                 const FieldParameters& parameters, const FieldData& data,
                 FieldPosterior& result) const;
  [[nodiscard]] double prior_log_determinant(const FieldParameters& parameters) const;

  // Pattern of a factor, found once.
  struct Factor {
    SparseFactor factor;
    bool analysed = false;
  };
  void factorise(Factor& factor, const SparseSquare& matrix,
                 const FieldParameters& parameters) const;

  SurfaceMesh mesh_;
  std::vector<AttachedPoint> point_;
  SurfaceOperator operator_;
  Eigen::VectorXd sag_m2_;             // (n) e^2 / 16
  std::array<SparseSquare, 4> power_;  // C, G, G C^-1 G, G C^-1 G C^-1 G
  Eigen::SparseMatrix<double> attachment_;
  // The last log |Q|: several sets of data ask for the same.
  mutable std::optional<std::pair<FieldParameters, double>> last_prior_;
  mutable Factor elliptic_factor_;
  mutable std::array<Factor, 2> posterior_factor_;  // by smoothness
};

}  // namespace palpate
