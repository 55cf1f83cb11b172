// Many small computations that share one factor, run side by side so that their solves
// go out in blocks.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/fem/cholesky_factor.h"

namespace palpate {

/// How well K^-1 is wanted: as the factor is, or by its numbers rounded
/// (FactorPart::rounded()) where that is faster, which makes a preconditioner.
enum class SolveWith { kFactor, kRounded };

/// K^-1 restricted to some unknowns: `source` acts on the unknowns `dof`, the result is
/// the displacement of the same unknowns. Entries of `dof` below zero are held: their
/// source is ignored, their displacement zero.
using RestSolve = std::function<Eigen::VectorXd(
    std::span<const std::int64_t> dof, const Eigen::VectorXd& source, SolveWith with)>;

/// One solve at a time, from one thread at a time.
[[nodiscard]] RestSolve single_solves(const CholeskyFactor& factor);

/// Runs every task to its end, as coroutines of the calling thread. Each task goes on
/// until it asks for a solve; when all wait, one block solve serves them. Blocks of 32
/// cost several times less per column than single solves. The blocks' composition
/// depends on the tasks alone. So results are the same bits on every thread and
/// machine.
///
/// Where a task throws, the others still end, and the first task's exception is thrown.
/// What a solve throws, every task that waited for the solve throws.
void run_in_lock_step(const CholeskyFactor& factor,
                      std::span<const std::function<void(const RestSolve&)>> tasks);

}  // namespace palpate
