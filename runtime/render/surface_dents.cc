#include "runtime/render/surface_dents.h"

#include <algorithm>

namespace palpate {

std::vector<SurfaceDent> surface_dents(const FastState& state) {
  const SurfaceMemory& memory = state.memory;
  std::vector<SurfaceDent> dents;
  if (!remembers(memory)) {
    return dents;
  }
  // What is at hand is newer than the table: put back into a copy of it.
  SurfaceMemory all = memory;
  put_back(state.config.model == LocalModel::kPotential ? state.potential.contact.sites
                                                        : state.element.contact.sites,
           all);
  for (int row = 0; row < kMemorySites; ++row) {
    if (const double carried = carried_n(all, row); carried > 0.0) {
      dents.push_back({all.row[static_cast<std::size_t>(row)].site, carried});
    }
  }
  std::sort(dents.begin(), dents.end(), [](const SurfaceDent& a, const SurfaceDent& b) {
    return a.site < b.site;
  });
  return dents;
}

}  // namespace palpate
