// A table of responses that relax gets its memory.
#pragma once

#include <cstdint>

#include "formats/response/response_table.h"

namespace palpate {

/// The table's responses relax and yield so, and the surface remembers them at sites
/// two contact radii apart (memory_sites.h). Nothing where neither is so, or there is
/// no response. Cuts of bundles lie at (i / bundles)^1.5 of the largest depth: closer
/// where curves bend more.
/// @param relaxation but for sites and bundles.
/// @param bundles [1, kMostBundles]
void give_memory(const SurfaceMesh& body, const Points& normal,
                 const Viscoelasticity& relaxation, std::int64_t bundles,
                 ResponseTable& table);

}  // namespace palpate
