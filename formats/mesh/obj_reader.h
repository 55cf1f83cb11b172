// Points and faces of a Wavefront OBJ file.
#pragma once

#include <string>

#include "formats/mesh/stl_reader.h"

namespace palpate {

/// Reads the statements `v` and `f`; all others, and comments, are passed over. Lines
/// end with LF, CR LF or CR, and go on after a backslash. A face's corners are
/// v, v/vt, v//vn or v/vt/vn, from 1, or negative: back from the latest vertex.
/// @throws FormatError naming the vertex or the face that cannot be read, and its line.
[[nodiscard]] PolygonSoup read_obj(std::string bytes);

}  // namespace palpate
