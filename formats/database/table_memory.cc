#include "formats/database/table_memory.h"

#include <cmath>
#include <vector>

#include "formats/response/memory_sites.h"

namespace palpate {

void give_memory(const SurfaceMesh& body, const Points& normal,
                 const Viscoelasticity& relaxation, std::int64_t bundles,
                 ResponseTable& table) {
  if (!relaxation.remembers() || table.depth_m.empty()) {
    return;
  }
  const double depth_max_m = table.depth_max_m();
  std::vector<bool> remembers;
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    remembers.push_back(!table.curve(node).depth_m.empty());
  }
  table.viscoelasticity = relaxation;
  table.viscoelasticity.sites =
      place_sites(body, normal, remembers, site_spacing_m(table.tool, depth_max_m));
  for (std::int64_t i = 1; i < bundles && !relaxation.empty(); ++i) {
    table.viscoelasticity.bundle_depth_m.push_back(
        depth_max_m *
        std::pow(static_cast<double>(i) / static_cast<double>(bundles), 1.5));
  }
}

}  // namespace palpate
