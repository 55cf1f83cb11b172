#include "runtime/render/surface_dents.h"

#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

std::vector<SurfaceDent> surface_dents(const FastState& state) {
  const SurfaceMemory& memory = state.memory;
  std::vector<SurfaceDent> dents;
  if (!remembers(memory) && memory.yielded.count == 0) {
    return dents;
  }
  // What is at hand is newer than the table: put back into a copy of it.
  SurfaceMemory all = memory;
  put_back(state.config.model == LocalModel::kPotential ? state.potential.contact.sites
                                                        : state.element.contact.sites,
           all);
  std::map<std::int32_t, SurfaceDent> by_site;
  for (int row = 0; row < kMemorySites; ++row) {
    if (const double carried = carried_n(all, row); carried > 0.0) {
      by_site[all.row[static_cast<std::size_t>(row)].site].carried_n = carried;
    }
  }
  for (const YieldedSite& row : all.yielded.row) {
    if (row.dent_m > 0.0) {
      by_site[row.site].stays_m = row.dent_m;
    }
  }
  for (auto& [site, dent] : by_site) {
    dent.site = site;
    dents.push_back(dent);
  }
  return dents;
}

std::vector<YieldedRow> yielded_rows(const FastState& state) {
  std::vector<YieldedRow> rows;
  for (const YieldedSite& row : state.memory.yielded.row) {
    if (row.dent_m > 0.0 || row.softened_m > 0.0) {
      rows.push_back({row.site, row.dent_m, row.softened_m});
    }
  }
  std::sort(rows.begin(), rows.end(), [](const YieldedRow& a, const YieldedRow& b) {
    return a.site < b.site;
  });
  return rows;
}

void begin_yielded(const std::vector<YieldedRow>& rows, FastState& state) {
  const auto sites = std::make_unique<YieldedSites>();
  for (const YieldedRow& from : rows) {
    const int row = claim_yielded(*sites, from.site);
    if (row < 0) {
      throw InputError(fmt::format(
          "a surface with {} sites that have yielded cannot be held, {} at most can",
          rows.size(), kYieldedSites));
    }
    sites->row[static_cast<std::size_t>(row)] = {
        from.site, static_cast<Real>(from.dent_m), static_cast<Real>(from.softened_m)};
  }
  state.memory.yielded = *sites;
}

}  // namespace palpate
