#include "precompute/contact/surface_compliance.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include <fmt/format.h>

#include "precompute/contact/face_quadrature.h"
#include "precompute/contact/loaded_part.h"
#include "precompute/fem/load_compliance.h"
#include "precompute/process/machine_memory.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

std::int64_t free_index(const Supports& supports, std::int32_t node, int axis) {
  return supports
      .free_index[3 * static_cast<std::size_t>(node) + static_cast<std::size_t>(axis)];
}

// Nodes of `nodes` within the radius of each of them, ascending: a sweep along x.
std::vector<std::vector<std::int32_t>> near_pairs(const ContactSurface& surface,
                                                  std::span<const std::int32_t> nodes,
                                                  double radius_m) {
  const auto position = [&](std::int32_t v) -> const Eigen::Vector3d& {
    return surface.node[static_cast<std::size_t>(v)].position_m;
  };
  std::vector<std::int32_t> by_x(nodes.begin(), nodes.end());
  std::sort(by_x.begin(), by_x.end(), [&](std::int32_t a, std::int32_t b) {
    return position(a).x() < position(b).x();
  });
  std::vector<std::vector<std::int32_t>> near(surface.node.size());
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    // Nodes are sorted by x: the first that is too far in x alone ends the search.
    for (std::size_t j = i; j < by_x.size(); ++j) {
      const Eigen::Vector3d apart = position(by_x[j]) - position(by_x[i]);
      if (apart.x() > radius_m) {
        break;
      }
      if (apart.squaredNorm() <= radius_m * radius_m) {
        near[static_cast<std::size_t>(by_x[i])].push_back(by_x[j]);
        if (i != j) {
          near[static_cast<std::size_t>(by_x[j])].push_back(by_x[i]);
        }
      }
    }
  }
  for (auto& list : near) {
    std::sort(list.begin(), list.end());
  }
  return near;
}

}  // namespace

Supports hold_where(const QuadraticMesh& mesh, const Where& held) {
  Supports supports;
  supports.free_index.assign(static_cast<std::size_t>(3 * mesh.position_m.rows()), 0);
  for (const std::int32_t node : surface_nodes(mesh)) {
    if (held(mesh.position_m.row(node).transpose())) {
      std::fill_n(supports.free_index.begin() + 3 * std::ptrdiff_t{node}, 3, -1);
    }
  }
  // Numbers free unknowns in order and marks held ones by -1.
  for (std::int64_t& index : supports.free_index) {
    index = index < 0 ? -1 : supports.free++;
  }
  return supports;
}

Supports hold_boxes(const QuadraticMesh& mesh,
                    std::span<const Eigen::AlignedBox3d> box_m) {
  return hold_where(mesh, [&](const Eigen::Vector3d& p) {
    return std::any_of(box_m.begin(), box_m.end(), [&](const Eigen::AlignedBox3d& box) {
      return box.contains(p);
    });
  });
}

void for_points_there(
    const QuadraticMesh& mesh, Eigen::Index face, const Where& where,
    const std::function<void(const Eigen::Vector3d&, std::size_t)>& take) {
  const auto nodes = mesh.surface.row(face);
  const auto at = [&](int i) -> Eigen::Vector3d {
    return mesh.position_m.row(nodes[i]).transpose();
  };
  // Not each point for itself: rounding may put one beside a plane that all nodes are
  // in.
  const bool all = std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t n) {
    return where(mesh.position_m.row(n).transpose());
  });
  const std::vector<FaceRulePoint>& rule = face_rule();
  for (std::size_t i = 0; i < rule.size(); ++i) {
    const Eigen::Vector3d p_m =
        rule[i].at[0] * at(0) + rule[i].at[1] * at(1) + rule[i].at[2] * at(2);
    if (all || where(p_m)) {
      take(p_m, i);
    }
  }
}

void add_foundation(Stiffness& lower, const QuadraticMesh& mesh, double k_pa_per_m,
                    const Where& where) {
  for (Eigen::Index f = 0; f < mesh.surface.rows(); ++f) {
    const auto nodes = mesh.surface.row(f);
    const auto at = [&](int i) -> Eigen::Vector3d {
      return mesh.position_m.row(nodes[i]).transpose();
    };
    const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    for_points_there(mesh, f, where, [&](const Eigen::Vector3d&, std::size_t p) {
      const FaceRulePoint& point = face_rule()[p];
      // k integral of N_i N_j dA, the same for each axis [N/m]; the lower triangle
      // alone.
      const double k = k_pa_per_m * point.area_share * area;
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
          if (nodes[i] >= nodes[j]) {
            for (int axis = 0; axis < 3; ++axis) {
              lower.coeffRef(3 * nodes[i] + axis, 3 * nodes[j] + axis) +=
                  k * point.shape[i] * point.shape[j];
            }
          }
        }
      }
    });
  }
}

double average_displacement(const ContactNode& node, const Supports& supports,
                            const Eigen::Ref<const Eigen::VectorXd>& u_m) {
  double sum = 0.0;
  for (const NodalForce& entry : node.load) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t dof = free_index(supports, entry.node, axis);
      if (dof >= 0) {
        sum += entry.force[axis] * u_m[dof];
      }
    }
  }
  return sum;
}

Stiffness reduce(const Stiffness& lower, const Supports& supports) {
  Stiffness K(supports.free, supports.free);
  const auto index = [&](std::int64_t dof) {
    return supports.free_index[static_cast<std::size_t>(dof)];
  };
  // The first pass counts entries, the second fills them in. Free unknowns keep their
  // order: columns stay sorted, and the lower triangle stays one.
  std::int64_t kept = 0;
  for (int pass = 0; pass < 2; ++pass) {
    kept = 0;
    for (std::int64_t column = 0; column < lower.cols(); ++column) {
      if (index(column) < 0) {
        continue;
      }
      if (pass == 1) {
        K.outerIndexPtr()[index(column)] = kept;
      }
      for (Stiffness::InnerIterator entry(lower, column); entry; ++entry) {
        if (index(entry.row()) >= 0) {
          if (pass == 1) {
            K.innerIndexPtr()[kept] = index(entry.row());
            K.valuePtr()[kept] = entry.value();
          }
          ++kept;
        }
      }
    }
    if (pass == 0) {
      K.resizeNonZeros(kept);
    }
  }
  K.outerIndexPtr()[supports.free] = kept;
  return K;
}

SurfaceCompliance::SurfaceCompliance(const CholeskyFactor& factor,
                                     const Supports& supports,
                                     const ContactSurface& surface,
                                     std::span<const std::int32_t> nodes,
                                     double radius_m, std::span<const char> wanted,
                                     const std::function<void(std::size_t)>& progress) {
  // 1. Pattern: column v keeps its neighbours within the radius.
  for (const auto& list : near_pairs(surface, nodes, radius_m)) {
    const auto begin = static_cast<std::int64_t>(neighbour_.size());
    column_.push_back({begin, begin, std::ssize(list)});
    neighbour_.insert(neighbour_.end(), list.begin(), list.end());
  }
  const double bytes = sizeof(double) * static_cast<double>(neighbour_.size());
  require_free_memory(
      bytes, bytes, fmt::format("the compliance among {} contact nodes", nodes.size()),
      "refine under the tool alone (accuracy.refine = \"local\"), or ask for a lower "
      "contact_resolution");
  value_.setZero(std::ssize(neighbour_), 1);
  // 2. Values: (v, w) = b_v^T K^-1 b_w, b the consistent load of 1 N over a hat [m/N].
  const LoadedPart loaded = loaded_part(factor, supports, surface, nodes);
  const std::vector<std::int32_t> columns = by_elimination(loaded, surface, nodes);
  std::atomic<std::size_t> done = 0;
  std::mutex reporting;
  const auto solve_if_needed = [&](std::size_t first) {
    const std::size_t count = std::min(kBlock, columns.size() - first);
    const std::span block(columns.data() + first, count);
    if (wanted.empty() || std::any_of(block.begin(), block.end(), [&](std::int32_t v) {
          return wanted[static_cast<std::size_t>(v)] != 0;
        })) {
      solve_block(loaded, surface, block);
    }
    done += count;
    if (progress && reporting.try_lock()) {
      const std::lock_guard lock(reporting, std::adopt_lock);
      progress(done);
    }
  };
  const std::size_t blocks = (columns.size() + kBlock - 1) / kBlock;
  in_parallel(blocks, [&](std::size_t i) {
    solve_if_needed(i * kBlock);
  });
}

SurfaceCompliance::SurfaceCompliance(const CholeskyFactor& factor,
                                     const Supports& supports,
                                     const ContactSurface& surface,
                                     std::span<const std::int32_t> nodes)
    : column_(surface.node.size()), neighbour_(nodes.begin(), nodes.end()) {
  const LoadedPart loaded = loaded_part(factor, supports, surface, nodes);
  value_ = load_compliance(loaded.factor, unit_loads(loaded, surface, nodes));
  std::int64_t value = 0;
  for (const std::int32_t v : nodes) {
    column_[static_cast<std::size_t>(v)] = {0, value, std::ssize(nodes)};
    value += std::ssize(nodes);
  }
}

void SurfaceCompliance::solve_block(const LoadedPart& loaded,
                                    const ContactSurface& surface,
                                    std::span<const std::int32_t> columns) {
  const auto count = static_cast<Eigen::Index>(columns.size());
  SolveRows X = SolveRows::Zero(loaded.supports.free, solve_width(count));
  std::vector<std::size_t> next(columns.size(), 0);     // entry that is to be filled
  std::vector<char> has_entry(surface.node.size(), 0);  // in some column, by row
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::int32_t v = columns[static_cast<std::size_t>(k)];
    add_load(surface.node[static_cast<std::size_t>(v)], 1.0, loaded.supports, X, k);
    for (const std::int32_t w : neighbours(v)) {
      has_entry[static_cast<std::size_t>(w)] = 1;
    }
  }
  loaded.factor.solve(X);
  // Rows are visited in ascending order, as each column keeps them. `next` is therefore
  // a column's only place where the row can belong.
  Eigen::RowVectorXd average(X.cols());
  for (std::size_t w = 0; w < has_entry.size(); ++w) {
    if (has_entry[w] == 0) {
      continue;
    }
    average_rows(surface.node[w], loaded.supports, X, average);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto rows = neighbours(columns[k]);
      if (next[k] < rows.size() && rows[next[k]] == static_cast<std::int32_t>(w)) {
        values(columns[k])[next[k]++] = average[static_cast<Eigen::Index>(k)];
      }
    }
  }
}

// In the order in which the unknowns that they load are eliminated: what a block of
// columns loads begins late for most of them.
std::vector<std::int32_t> SurfaceCompliance::by_elimination(
    const LoadedPart& loaded, const ContactSurface& surface,
    std::span<const std::int32_t> columns) {
  std::vector<std::pair<std::int64_t, std::int32_t>> by_first;
  for (const std::int32_t v : columns) {
    std::int64_t first = loaded.supports.free;
    for (const NodalForce& entry : surface.node[static_cast<std::size_t>(v)].load) {
      const std::int64_t dof = free_index(loaded.supports, entry.node, 0);
      first = dof >= 0 ? std::min(first, dof) : first;
    }
    by_first.emplace_back(first, v);
  }
  std::sort(by_first.begin(), by_first.end());
  std::vector<std::int32_t> ordered;
  for (const auto& [first, v] : by_first) {
    ordered.push_back(v);
  }
  return ordered;
}

void SurfaceCompliance::add(std::span<const std::int32_t> nodes,
                            const Eigen::MatrixXd& more) {
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    for_entries(nodes[j], nodes, [&](Eigen::Index i, std::size_t at) {
      values(nodes[j])[at] += more(i, static_cast<Eigen::Index>(j));
    });
  }
}

// Both lists ascend: one walk for each column.
template <typename Entry>
void SurfaceCompliance::for_entries(std::int32_t column,
                                    std::span<const std::int32_t> rows,
                                    const Entry& entry) const {
  const auto kept = neighbours(column);
  std::size_t at = 0;
  for (std::size_t i = 0; i < rows.size() && at < kept.size(); ++i) {
    while (at < kept.size() && kept[at] < rows[i]) {
      ++at;
    }
    if (at < kept.size() && kept[at] == rows[i]) {
      entry(static_cast<Eigen::Index>(i), at);
    }
  }
}

Eigen::MatrixXd SurfaceCompliance::among(std::span<const std::int32_t> nodes) const {
  const auto n = static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::int32_t v = nodes[static_cast<std::size_t>(j)];
    const double* const value = values(v);
    for_entries(v, nodes, [&](Eigen::Index i, std::size_t at) {
      if (i <= j) {
        A(i, j) = value[at];
        A(j, i) = value[at];
      }
    });
  }
  return A;
}

Eigen::MatrixXd SurfaceCompliance::between(
    std::span<const std::int32_t> rows, std::span<const std::int32_t> columns) const {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()),
                                            static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    const std::int32_t v = columns[static_cast<std::size_t>(j)];
    const double* const value = values(v);
    for_entries(v, rows, [&](Eigen::Index i, std::size_t at) {
      A(i, j) = value[at];
    });
  }
  return A;
}

}  // namespace palpate
