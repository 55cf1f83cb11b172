// A surface, written for other programs to read.
#pragma once

#include <filesystem>
#include <string_view>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Writes a Wavefront OBJ file in metres: vertices and triangles in their order, each
/// number with the digits that read back to the same double.
/// @param comment one line for the file's head; says where the body comes from.
/// @throws InputError if the file's name does not end in .obj or it cannot be written.
void write_obj(const SurfaceMesh& mesh, const std::filesystem::path& file,
               std::string_view comment);

}  // namespace palpate
