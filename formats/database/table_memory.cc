#include "formats/database/table_memory.h"

#include <vector>

#include "formats/base/reproducible.h"
#include "formats/response/memory_sites.h"

namespace palpate {
namespace {

// Nodes that share a triangle with one that has a response: between the two the surface
// yields as much as farther in.
void add_rim(const SurfaceMesh& body, std::vector<bool>& remembers) {
  const std::vector<bool> inner = remembers;
  const auto is_inner = [&](std::int32_t node) {
    return inner[static_cast<std::size_t>(node)];
  };
  for (const auto& corner : body.triangle.rowwise()) {
    if (is_inner(corner[0]) || is_inner(corner[1]) || is_inner(corner[2])) {
      for (const std::int32_t node : corner) {
        remembers[static_cast<std::size_t>(node)] = true;
      }
    }
  }
}

}  // namespace

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
  if (!relaxation.yielding.empty()) {
    add_rim(body, remembers);
  }
  table.viscoelasticity = relaxation;
  table.viscoelasticity.sites =
      place_sites(body, normal, remembers, site_spacing_m(table.tool, depth_max_m));
  for (std::int64_t i = 1; i < bundles && !relaxation.empty(); ++i) {
    table.viscoelasticity.bundle_depth_m.push_back(
        depth_max_m *
        reproducible::pow(static_cast<double>(i) / static_cast<double>(bundles), 1.5));
  }
}

}  // namespace palpate
