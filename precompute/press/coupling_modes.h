// Modes by which parts of a body move as a whole under a contact, whatever the
// distance.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "formats/response/compliance_table.h"

namespace palpate {

/// Gives a table the modes that bring it nearest to exact compliances: the largest
/// eigenvectors, by size, of what the table misses. Pairs nearer than the table's first
/// distance are not missed: they take what the modes of the others say (repeated, from
/// zero).
/// @param compliance_m_per_n (n x n) [m/N] between some nodes; not read for pairs that
/// are near.
/// @param node (n) of the table.
void add_modes(const Eigen::MatrixXd& compliance_m_per_n,
               std::span<const std::int32_t> node, const Points& position_m,
               ComplianceTable& table);

}  // namespace palpate
