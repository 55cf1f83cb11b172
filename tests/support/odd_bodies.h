// Bodies on which a press is not that of a ball on a flat place.
#pragma once

#include <functional>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// A block over [-half, half]^2 whose top is z = height_m(x, y), its floor z = floor_m.
/// The top has (cells + 1)^2 vertices, row by row from x = y = -half, and the floor as
/// many.
[[nodiscard]] SurfaceMesh relief(double half_m, double floor_m, int cells,
                                 const std::function<double(double, double)>& height_m);

/// Index of the top's vertex nearest to a place.
[[nodiscard]] std::int32_t top_vertex(double half_m, int cells, double x_m, double y_m);

/// Leans a body: above z = 0, x grows by `slope` times z. Below z = 0 the body leans
/// the other way, by `slope_below` times -z.
[[nodiscard]] SurfaceMesh leaning(SurfaceMesh body, double slope,
                                  double slope_below = 0.0);

}  // namespace palpate
