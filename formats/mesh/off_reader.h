// Points and faces of an OFF file.
#pragma once

#include <string>

#include "formats/mesh/stl_reader.h"

namespace palpate {

/// Reads text OFF of three coordinates, one vertex and one face a line, with the
/// prefixes ST, C and N. Normals, colours and texture coordinates are passed over, as
/// are comments and empty lines.
/// @throws FormatError naming what the file is instead, or the vertex or the face that
/// cannot be read, and its line.
[[nodiscard]] PolygonSoup read_off(std::string bytes);

}  // namespace palpate
