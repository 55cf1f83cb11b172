// The linear complementarity problem of frictionless contact on a small patch.
#pragma once

#include <Eigen/Core>

namespace palpate {

struct ComplementarityReport {
  bool converged = false;
  int iterations = 0;
  double residual = 0.0;  ///< [m] largest violation of gap >= 0 among free nodes
};

/// Finds contact forces f >= 0 [N] with w = A f + t >= 0 and f.w = 0. The forces press
/// a surface of compliance A [m/N] out of a tool. A is n x n, symmetric positive
/// definite; t [m] are the tool's gaps at rest. Equivalently, f is the minimum of
/// f'Af/2 + t'f over f >= 0.
///
/// The method is block principal pivoting (Judice and Pires 1994): it exchanges all
/// infeasible indices at once. When three blocks in a row bring no progress, it
/// exchanges the largest index alone (Murty 1974). The single exchange ends for every
/// positive definite A.
/// @param f on entry a start: its positive entries are the first guess of the contact.
ComplementarityReport solve_complementarity(const Eigen::MatrixXd& A,
                                            const Eigen::VectorXd& t,
                                            Eigen::VectorXd& f);

}  // namespace palpate
