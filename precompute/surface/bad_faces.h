// The triangles that a surface is refused for, to look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// What is wrong with a triangle; of several things the last of the list.
enum class FaceFault : std::uint8_t {
  kBorder,            ///< an edge of it has no other triangle: yellow
  kFlipped,           ///< it and a neighbour face opposite ways: blue
  kNonManifold,       ///< an edge of it has more than two triangles: magenta
  kDegenerate,        ///< it has no area: cyan
  kSelfIntersecting,  ///< it cuts through another: red
};

struct BadFace {
  std::int32_t triangle = 0;
  FaceFault fault = FaceFault::kBorder;
};

/// Ascending by triangle.
[[nodiscard]] std::vector<BadFace> bad_faces(const SurfaceMesh& mesh);

/// Writes the bad triangles, and no others, as a PLY file (text, metres) with the
/// colours above. Each face has `fault` (the place in the list above, from 0) and
/// `triangle` (its number in the mesh, from 0).
/// @throws InputError if the name does not end in .ply or the file cannot be written.
void write_bad_faces(const SurfaceMesh& mesh, const std::vector<BadFace>& faces,
                     const std::filesystem::path& file);

}  // namespace palpate
