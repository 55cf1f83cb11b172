// The part of a factor that loads on contact nodes act on.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/contact/contact_surface.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/cholesky_factor.h"
#include "precompute/fem/load_compliance.h"

namespace palpate {

/// A solve in it costs what it holds. Must not outlive its factor.
struct LoadedPart {
  FactorPart factor;
  Supports supports;  ///< as the part sees them: free_index are its rows
};

/// @param nodes contact nodes that will be loaded, or whose displacement is wanted.
[[nodiscard]] LoadedPart loaded_part(const CholeskyFactor& factor,
                                     const Supports& supports,
                                     const ContactSurface& surface,
                                     std::span<const std::int32_t> nodes);

/// 1 N of pressure force over the hat of each node, one column each.
[[nodiscard]] LoadColumns unit_loads(const LoadedPart& loaded,
                                     const ContactSurface& surface,
                                     std::span<const std::int32_t> nodes);

/// Adds a pressure force over the hat of a node to a column of loads.
void add_load(const ContactNode& node, double force_n, const Supports& supports,
              SolveRows& B, Eigen::Index column);

/// average_displacement() of a node, for all right-hand sides.
void average_rows(const ContactNode& node, const Supports& supports, const SolveRows& X,
                  Eigen::Ref<Eigen::RowVectorXd> average);

/// Pressure forces at some contact nodes.
struct PressureForces {
  std::vector<std::int32_t> node;
  std::vector<double> force_n;  ///< (n) [N]
};

/// Calls take(k, u) with the average inward displacements u (n_rows) [m] at the rows
/// under load[k]: each once, from several threads, in no order. Of what a
/// SurfaceCompliance keeps no more than is near, this is all.
/// @param rows contact nodes; held parts of the surface do not move.
/// @param progress called now and then from one thread with the loads done; may be
/// null.
void for_each_column(
    const CholeskyFactor& factor, const Supports& supports,
    const ContactSurface& surface, std::span<const std::int32_t> rows,
    std::span<const PressureForces> load,
    const std::function<void(std::size_t, const Eigen::VectorXd&)>& take,
    const std::function<void(std::size_t)>& progress);

}  // namespace palpate
