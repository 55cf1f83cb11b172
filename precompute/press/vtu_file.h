// A deformed body for ParaView.
#pragma once

#include <filesystem>
#include <span>

#include <Eigen/Core>

#include "precompute/fem/quadratic_mesh.h"

namespace palpate {

/// Writes a VTK XML unstructured grid of quadratic tets (cell type 24), with points at
/// their displaced places. Point data: `displacement` [m]. Cell data: `det_f` (smallest
/// of the four integration points), `region`, `near`. The file appears whole or not at
/// all.
/// @param u_m (3 n_nodes) [m]. @param near (n_tets).
/// @throws InputError if the file cannot be written.
void write_vtu(const std::filesystem::path& file, const QuadraticMesh& mesh,
               const Eigen::VectorXd& u_m, std::span<const char> near);

}  // namespace palpate
