// The parts of a surface that share no vertex.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct SurfacePart {
  std::vector<Eigen::Index> triangle;  ///< ascending
  bool closed = true;                  ///< each of its edges has two triangles
  double area_m2 = 0.0;
  double volume_m3 = 0.0;    ///< as it faces; 0 of an open part
  Eigen::Vector3d middle_m;  ///< [m] of its bounding box
  bool speck = false;        ///< of no use to a press, see kSpeckShare
  int around = 0;            ///< closed parts that it lies in; check_surface() counts

  [[nodiscard]] bool is_cavity() const { return around % 2 == 1; }  ///< its wall
};

/// [-] A speck has less than this share of the volume of all parts, or, if it is open,
/// of the area of all. Where specks are more than ten times this share of the area
/// together, none is one: the surface is in pieces.
inline constexpr double kSpeckShare = 1e-3;

/// By their first triangle.
[[nodiscard]] std::vector<SurfacePart> surface_parts(const SurfaceMesh& mesh);

/// These triangles of a surface, ascending, with their vertices alone in their order.
[[nodiscard]] SurfaceMesh of_triangles(const SurfaceMesh& mesh,
                                       std::vector<Eigen::Index> triangle);

/// The part as a surface of its own, three vertices to a triangle. The time grows with
/// the part; the time of of_triangles() grows with the mesh.
[[nodiscard]] SurfaceMesh part_mesh(const SurfaceMesh& mesh, const SurfacePart& part);

}  // namespace palpate
