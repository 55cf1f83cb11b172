// How the surface deforms, for drawing: of stored displacement fields.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "formats/response/response_table.h"

namespace palpate {

/// Row of the deepest field of a node; -1: none is stored.
[[nodiscard]] Eigen::Index deepest_field(const DisplacementField& field,
                                         std::int32_t node);

/// A field, and how deep it is pressed: displacements are in proportion.
struct PressedField {
  Eigen::Index row = -1;  ///< of the field
  double depth_m = 0.0;   ///< [m]
};

/// Displacements of all vertices (n x 3) [m], added up. Rows j with depths a_j give
/// basis sum_j a_j / depth_m[j] coefficient.row(j)^T. The sum is in double precision
/// (singles of a foreign file may overflow). Empty where no field is stored at all.
[[nodiscard]] Points displaced_m(const DisplacementField& field,
                                 std::span<const PressedField> pressed);

}  // namespace palpate
