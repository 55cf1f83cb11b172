// What loads do to one another in an elastic body, without the displacements between.
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "precompute/fem/cholesky_factor.h"

namespace palpate {

/// Loads that each act on a few unknowns, one a column.
using LoadColumns = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

/// A' K^-1 A = Y'Y with Y = L^-1 A. This is forward elimination alone, where solves for
/// the columns would go backward, too. The method is multifrontal (Duff and Reid 1983),
/// as if A' stood below L's rows and its Schur complement were wanted. Y is never held
/// whole, and a load costs nothing before the first of its unknowns is eliminated. Runs
/// on the calling thread alone.
/// @param A (part.size() x n), rows as part.row() says.
/// @return (n x n), symmetric; the same bits on every processor.
[[nodiscard]] Eigen::MatrixXd load_compliance(const FactorPart& part,
                                              const LoadColumns& A);

}  // namespace palpate
