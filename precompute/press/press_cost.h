// What linear presses on a mesh cost, counted before anything is meshed.
#pragma once

#include <cstdint>
#include <span>

#include "formats/scene/scene.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/body/scene_body.h"

namespace palpate {

/// One mesh: its surface triangles, and the columns of the surface compliance that its
/// presses need.
struct MeshWork {
  double triangles = 0.0;
  double columns = 0.0;
};

/// CPU seconds of one core of a machine of 2026 for a mesh, its factor and its columns:
/// a T^1.48 + b columns T^1.24. T is the number of surface triangles of a compact body,
/// whose factor has non-zeros in proportion to T^1.24 (machine_memory.h). The constants
/// come from a sphere of 25,920 triangles (25 s of factor, 0.047 s a column). The
/// estimate is for choosing between meshes, where only the ratio of two costs counts.
[[nodiscard]] double expected_cpu_s(const MeshWork& work);

/// Of one column alone.
[[nodiscard]] double expected_column_cpu_s(double triangles);

/// Of one mesh for the vertices (make_graded_model): its surface is made and counted.
[[nodiscard]] MeshWork own_mesh_work(const Scene& scene, const BodySource& body,
                                     std::span<const std::int32_t> vertices,
                                     const ContactFocus& focus);

/// CPU seconds of linear presses of all vertices on meshes of their own: one group
/// stands for all.
[[nodiscard]] double expected_own_meshes_cpu_s(const Scene& scene,
                                               const BodySource& body,
                                               std::span<const std::int32_t> vertices,
                                               const ContactFocus& focus);

}  // namespace palpate
