#include "runtime/render/surface_dents.h"

#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/render/kept_channels.h"

namespace palpate {

namespace {

using DentsBySite = std::map<std::int32_t, SurfaceDent>;

void add_dents(const SurfaceMemory& memory, const SitesAtHand& at_hand,
               DentsBySite& by_site) {
  if (!remembers(memory) && memory.yielded.count == 0) {
    return;
  }
  // What is at hand is newer than the table: put back into a copy of it.
  const auto all = std::make_unique<SurfaceMemory>(memory);
  put_back(at_hand, *all);
  for (int row = 0; row < kMemorySites; ++row) {
    if (const double carried = carried_n(*all, row); carried > 0.0) {
      double& most = by_site[all->row[static_cast<std::size_t>(row)].site].carried_n;
      most = std::max(most, carried);
    }
  }
  for (const YieldedSite& row : all->yielded.row) {
    if (row.dent_m > 0.0) {
      by_site[row.site].stays_m = row.dent_m;
    }
  }
}

std::vector<SurfaceDent> in_order(const DentsBySite& by_site) {
  std::vector<SurfaceDent> dents;
  for (const auto& [site, dent] : by_site) {
    dents.push_back(dent);
    dents.back().site = site;
  }
  return dents;
}

// By site.
std::vector<YieldedRow> rows_of(const YieldedSites& sites, int table) {
  std::vector<YieldedRow> rows;
  for (const YieldedSite& row : sites.row) {
    if (row.dent_m > 0.0 || row.softened_m > 0.0) {
      rows.push_back({row.site, row.dent_m, row.softened_m, table});
    }
  }
  std::sort(rows.begin(), rows.end(), [](const YieldedRow& a, const YieldedRow& b) {
    return a.site < b.site;
  });
  return rows;
}

// Of the rows of one table.
std::unique_ptr<YieldedSites> sites_of(const std::vector<YieldedRow>& rows, int table) {
  auto sites = std::make_unique<YieldedSites>();
  for (const YieldedRow& from : rows) {
    if (from.table != table) {
      continue;
    }
    const int row = claim_yielded(*sites, from.site);
    if (row < 0) {
      throw InputError(fmt::format(
          "a surface with {} sites that have yielded cannot be held, {} at most can",
          rows.size(), kYieldedSites));
    }
    sites->row[static_cast<std::size_t>(row)] = {
        from.site, static_cast<Real>(from.dent_m), static_cast<Real>(from.softened_m)};
  }
  return sites;
}

// @throws InputError for a row of a table that the body does not have.
template <typename Row>
void check_tables(const std::vector<Row>& rows, int tables) {
  for (const Row& row : rows) {
    if (row.table < 0 || row.table >= tables) {
      throw InputError(fmt::format(
          "a surface that was pressed by responses number {}, the tools have {}",
          row.table, tables));
    }
  }
}

// Of a table's contacts the first; -1: it has none. What has yielded is theirs
// together.
int first_of(const CoupledSet& set, int table) {
  for (int i = 0; i < set.count; ++i) {
    if (set.sphere[static_cast<std::size_t>(i)].table == table) {
      return i;
    }
  }
  return -1;
}

}  // namespace

std::vector<SurfaceDent> surface_dents(const FastState& state) {
  DentsBySite by_site;
  add_dents(state.memory,
            is_field(state.config.model) ? state.potential.contact.sites
                                         : state.element.contact.sites,
            by_site);
  return in_order(by_site);
}

std::vector<SurfaceDent> surface_dents(const CoupledState& state, int table) {
  if (is_alone(state.set)) {
    return surface_dents(*state.alone);
  }
  DentsBySite by_site;
  for (int i = 0; i < state.set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (state.set.sphere[self].table == table) {
      add_dents(state.surfaces[i].memory, state.model.field.memory[self].sites,
                by_site);
    }
  }
  return in_order(by_site);
}

KeptSurface kept_surface(const FastState& state) {
  return {.yielded = rows_of(state.memory.yielded, 0),
          .channels = channel_rows(state.needle)};
}

KeptSurface kept_surface(const CoupledState& state) {
  if (is_alone(state.set)) {
    return kept_surface(*state.alone);
  }
  KeptSurface kept;
  std::vector<YieldedRow>& all = kept.yielded;
  for (int table = 0; first_of(state.set, table) >= 0; ++table) {
    const SurfaceMemory& memory = state.surfaces[first_of(state.set, table)].memory;
    const std::vector<YieldedRow> some = rows_of(yielded_of(memory), table);
    all.insert(all.end(), some.begin(), some.end());
  }
  return kept;
}

void begin_kept(const KeptSurface& kept, FastState& state) {
  check_tables(kept.yielded, 1);
  check_tables(kept.channels, 1);
  const std::unique_ptr<YieldedSites> sites = sites_of(kept.yielded, 0);
  begin_channels(kept.channels, state.config.puncture, state.needle);
  state.memory.yielded = *sites;
}

void begin_kept(const KeptSurface& kept, CoupledState& state) {
  if (is_alone(state.set)) {
    begin_kept(kept, *state.alone);
    return;
  }
  if (!kept.channels.empty()) {
    throw InputError(
        "a surface with a needle's channels: a tool of several contacts has none");
  }
  std::vector<std::unique_ptr<YieldedSites>> tables;
  for (int table = 0; first_of(state.set, table) >= 0; ++table) {
    tables.push_back(sites_of(kept.yielded, table));
  }
  check_tables(kept.yielded, static_cast<int>(tables.size()));
  for (std::size_t table = 0; table < tables.size(); ++table) {
    const int i = first_of(state.set, static_cast<int>(table));
    yielded_of(state.surfaces[i].memory) = *tables[table];
  }
}

}  // namespace palpate
