// What some unknowns need of a factor.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "precompute/fem/supernodes.h"

namespace palpate {

/// The columns of L that some unknowns reach through the elimination tree. Where a
/// right-hand side acts on them alone and only their displacement is wanted,
/// substitution touches no other column: a solve costs what these hold, whatever else
/// the body has. Must not outlive its factor.
class FactorPart {
 public:
  FactorPart() = default;  ///< nothing, and not to be asked
  /// @param row as row().
  FactorPart(Supernodes nodes, std::vector<std::int64_t> row);

  /// (n) row of each unknown of K in solve(), -1: not in the part. Some more than were
  /// asked for are.
  [[nodiscard]] const std::vector<std::int64_t>& row() const;
  [[nodiscard]] Eigen::Index size() const;
  [[nodiscard]] std::int64_t nonzeros() const;
  /// Its columns, rows as row() says; as long as this lives.
  [[nodiscard]] SupernodeView supernodes() const;

  /// X <- (K^-1)_part,part X, rows as row() says. As safe as CholeskyFactor::solve(),
  /// whose bits these are for as many right-hand sides, one or several.
  /// @param X (size x solve_width()), at most kSolveWidthMax wide.
  void solve(SolveRows& X) const;
  /// One right-hand side, (size).
  void solve(Eigen::VectorXd& x) const;

  /// The same with L's numbers rounded to single precision, for single right-hand sides
  /// alone, which take half the time: to go through L is what they wait for. It solves
  /// with a matrix that is 1e-7 off, relative to the largest entries: a preconditioner.
  /// L is divided by its largest pivot first, so that no unit of stiffness matters.
  [[nodiscard]] FactorPart rounded() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace palpate
