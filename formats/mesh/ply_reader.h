// The Stanford polygon format: text, little-endian and big-endian.
#pragma once

#include <string_view>

#include "formats/mesh/stl_reader.h"

namespace palpate {

/// Reads the elements `vertex` and `face`. A vertex has the scalars x, y, z of any
/// type; a face has a list `vertex_indices` or `vertex_index` of any integer type.
/// Other elements and properties are passed over. Header lines may end with CR LF.
/// @throws FormatError naming the header line, or the element that is cut short or no
///   number (without a file name).
[[nodiscard]] PolygonSoup read_ply(std::string_view bytes);

}  // namespace palpate
