// The linear complementarity problem of frictionless contact on a small patch.
#pragma once

#include <Eigen/Core>

namespace palpate {

struct ComplementarityReport {
  bool converged = false;
  int iterations = 0;
  double residual = 0.0;  ///< [m] largest violation of gap >= 0 among free nodes
};

/// Finds f >= 0 with w = A f + t >= 0 and f.w = 0: contact forces f [N] that press a
/// surface of compliance A [m/N] (n x n, symmetric positive definite) out of a tool
/// whose gaps at rest are t [m]. Equivalently the minimum of f'Af/2 + t'f over f >= 0.
///
/// Block principal pivoting (Judice and Pires 1994): exchanges all infeasible indices
/// at once, and falls back on the single exchange of the largest index (Murty 1974),
/// which ends for every positive definite A, when three blocks in a row bring no
/// progress.
/// @param f on entry a start: its positive entries are the first guess of the contact.
ComplementarityReport solve_complementarity(const Eigen::MatrixXd& A,
                                            const Eigen::VectorXd& t,
                                            Eigen::VectorXd& f);

}  // namespace palpate
