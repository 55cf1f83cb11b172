// Fewer nodes of a body, for showing it.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct ThinBody {
  std::vector<std::int32_t> node;  ///< (k) nodes that stay, ascending
  Triangles triangle;              ///< (any x 3) indices into `node`
};

/// At most `most` nodes, one for each cell of a cubic grid over the body: the one
/// nearest to the mean of its cell's. The triangles whose corners lie in three cells
/// are kept, moved to the cells' nodes. The whole body where it has no more. Sheets
/// closer than a cell can merge: a picture, no body to compute with.
[[nodiscard]] ThinBody thin_body(const SurfaceMesh& body, std::int64_t most);

}  // namespace palpate
