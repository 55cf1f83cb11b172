#include "precompute/contact/loaded_part.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <vector>

#include "precompute/process/interrupt.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

// Calls with(dof, weight) for every free unknown that a node's load acts on.
template <typename With>
void for_each_load(const ContactNode& node, const Supports& supports,
                   const With& with) {
  for (const NodalForce& entry : node.load) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t dof =
          supports.free_index[3 * static_cast<std::size_t>(entry.node) +
                              static_cast<std::size_t>(axis)];
      if (dof >= 0) {
        with(dof, entry.force[axis]);
      }
    }
  }
}

}  // namespace

LoadedPart loaded_part(const CholeskyFactor& factor, const Supports& supports,
                       const ContactSurface& surface,
                       std::span<const std::int32_t> nodes) {
  std::vector<std::int64_t> unknowns;
  for (const std::int32_t v : nodes) {
    for_each_load(node_of(surface, v), supports, [&](std::int64_t dof, double) {
      unknowns.push_back(dof);
    });
  }
  LoadedPart loaded{factor.part(unknowns), supports};
  loaded.supports.free = loaded.factor.size();
  for (std::int64_t& dof : loaded.supports.free_index) {
    dof = dof >= 0 ? loaded.factor.row()[static_cast<std::size_t>(dof)] : dof;
  }
  return loaded;
}

LoadColumns unit_loads(const LoadedPart& loaded, const ContactSurface& surface,
                       std::span<const std::int32_t> nodes) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  std::int64_t column = 0;
  for (const std::int32_t v : nodes) {
    for_each_load(node_of(surface, v), loaded.supports,
                  [&](std::int64_t dof, double force) {
                    entries.emplace_back(dof, column, force);
                  });
    ++column;
  }
  LoadColumns loads(loaded.factor.size(), column);
  loads.setFromTriplets(entries.begin(), entries.end());
  return loads;
}

void add_load(const ContactNode& node, double force_n, const Supports& supports,
              SolveRows& B, Eigen::Index column) {
  for_each_load(node, supports, [&](std::int64_t dof, double force) {
    B(dof, column) += force_n * force;
  });
}

void average_rows(const ContactNode& node, const Supports& supports, const SolveRows& X,
                  Eigen::Ref<Eigen::RowVectorXd> average) {
  average.setZero();
  for_each_load(node, supports, [&](std::int64_t dof, double force) {
    average += force * X.row(dof);
  });
}

void for_each_column(
    const CholeskyFactor& factor, const Supports& supports,
    const ContactSurface& surface, std::span<const std::int32_t> rows,
    std::span<const PressureForces> load,
    const std::function<void(std::size_t, const Eigen::VectorXd&)>& take,
    const std::function<void(std::size_t)>& progress) {
  // Column k is u = B_rows^T K^-1 B_load f_k. B holds the consistent unit loads of
  // nodes, K^-1 the part of the factor on which loads and rows act.
  std::vector<std::int32_t> nodes(rows.begin(), rows.end());
  for (const PressureForces& forces : load) {
    nodes.insert(nodes.end(), forces.node.begin(), forces.node.end());
  }
  const LoadedPart loaded = loaded_part(factor, supports, surface, nodes);
  constexpr std::size_t kBlock = SurfaceCompliance::kBlock;
  std::atomic<std::size_t> done = 0;
  std::mutex reporting;
  in_parallel((load.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    check_interrupted();
    const std::size_t first = block * kBlock;
    const auto some = load.subspan(first, std::min(kBlock, load.size() - first));
    const auto count = static_cast<Eigen::Index>(some.size());
    // A block of right-hand sides is solved at once; columns past `count` stay zero.
    SolveRows X = SolveRows::Zero(loaded.supports.free, solve_width(count));
    for (Eigen::Index k = 0; k < count; ++k) {
      const PressureForces& forces = some[static_cast<std::size_t>(k)];
      for (std::size_t j = 0; j < forces.node.size(); ++j) {
        add_load(node_of(surface, forces.node[j]), forces.force_n[j], loaded.supports,
                 X, k);
      }
    }
    loaded.factor.solve(X);
    Eigen::MatrixXd u(static_cast<Eigen::Index>(rows.size()), count);
    Eigen::RowVectorXd average(X.cols());
    for (std::size_t j = 0; j < rows.size(); ++j) {
      average_rows(node_of(surface, rows[j]), loaded.supports, X, average);
      u.row(static_cast<Eigen::Index>(j)) = average.head(count);
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      take(first + static_cast<std::size_t>(k), u.col(k));
    }
    done += some.size();
    if (progress && reporting.try_lock()) {
      const std::lock_guard lock(reporting, std::adopt_lock);
      progress(done);
    }
  });
}

}  // namespace palpate
