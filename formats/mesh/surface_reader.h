// A user's surface file, read into metres.
//
// The file's own vertices and faces, nothing repaired: what is wrong with them is for
// surface_check.h to find.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Reads a Wavefront OBJ, STL (text or binary), PLY (text or binary of either byte
/// order) or OFF file, known by its extension.
///
/// None of them records a unit of length that can be trusted, so one is required (see
/// formats/base/units.h). Vertices keep their order and number in OBJ, PLY and OFF. STL
/// lists three points per face, so points that are equal but for rounding become one
/// vertex (weld_points.h). These vertices are numbered by first appearance. Faces of
/// more than three corners are cut into triangles without new vertices.
///
/// @param notes gains a line for what was passed over or welded, with the file's name.
///   It gains a line too for an extent outside [1e-4, 10] m.
/// @throws InputError if the file is missing, empty or of an unknown extension. So too
///   for a coordinate that is not finite, or a face with an index out of range. So too
///   for an extent outside [1e-7, 1e3] m (a slip of the unit).
/// @throws FormatError if the file is not what its extension says, or is cut short.
[[nodiscard]] SurfaceMesh read_surface(const std::filesystem::path& file,
                                       std::string_view length_unit,
                                       std::vector<std::string>* notes = nullptr);

}  // namespace palpate
