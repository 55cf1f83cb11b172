// The body of a stiffness picture: shaded triangles in SVG.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "formats/report/surface_map.h"

namespace palpate {

/// A rectangle of the picture [px], y downwards.
struct Panel {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

/// An orthographic camera and where its picture lands in a panel.
struct View {
  Eigen::Matrix3d axes;   ///< rows: right, up, towards the viewer; orthonormal
  double px_per_m = 1.0;  ///< [px/m] scale of lengths across the line of sight
  double origin_x = 0.0;  ///< [px] where the world's origin lands
  double origin_y = 0.0;  ///< [px]

  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector3d& position_m) const {
    const Eigen::Vector3d p = axes * position_m;
    return {origin_x + px_per_m * p.x(), origin_y - px_per_m * p.y()};
  }
};

/// A three-quarter view from above (z up) that fits the body into the panel. The view
/// is from the side that shows most of the surface that has responses.
[[nodiscard]] View choose_view(const SurfaceMesh& body, const SurfaceMap& map,
                               const Panel& panel);

/// The triangles that face the viewer, farthest first, coloured by stiffness (grey
/// where there is no response) and lit from the upper left. SVG elements.
[[nodiscard]] std::string draw_body(const SurfaceMesh& body, const Points& normal,
                                    const SurfaceMap& map, const View& view);

/// Whether a surface with this unit normal is seen well; what hides it is not asked.
[[nodiscard]] bool faces_viewer(const View& view, const Eigen::Vector3d& normal);

/// Marks nodes on the body, numbered from 1 as the curves are; those behind the body
/// are left out. SVG elements.
[[nodiscard]] std::string draw_marks(const SurfaceMesh& body, const Points& normal,
                                     const std::vector<std::int64_t>& nodes,
                                     const View& view);

}  // namespace palpate
