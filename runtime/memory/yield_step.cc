#include "runtime/memory/yield_step.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace palpate {
namespace {

// What is this near to its target is there.
constexpr Real kThere = rounding(1.0 + 1e-15, 1.0 + 1e-6);

using SiteValues = std::array<Real, kSitesAtHand>;

// Whether a site may take more: its row in the table, -1 if it has none.
using SiteRows = std::array<int, kSitesAtHand>;

// Raises values until their blend is the target or all are there; none passes it.
void raise(const SitesAtHand& sites, const SiteRows& row, Real target,
           SiteValues& value) {
  // Sites move along the gradient of the blend sum m_i v_i: v_i += step m_i. The blend
  // then rises by step sum m_i^2, which is to be what is missing.
  std::array<std::size_t, kSitesAtHand> mover{};
  std::size_t movers = 0;
  for (std::size_t i = 0; i < sites.count; ++i) {
    if (row[i] >= 0 && value[i] < target) {
      mover[movers++] = i;
    }
  }
  while (movers > 0) {
    Real missing = target - blended(sites, value).value;
    Real squares = 0.0;
    for (std::size_t n = 0; n < movers; ++n) {
      const Real w = sites.weight[mover[n]].value;
      squares += w * w;
    }
    if (!(missing > 0.0)) {
      return;
    }
    const Real step = missing / squares;
    // Sites that would pass the target arrive at it; the others share what is left
    // anew.
    std::size_t kept = 0;
    for (std::size_t n = 0; n < movers; ++n) {
      const std::size_t i = mover[n];
      if (value[i] + step * sites.weight[i].value < target) {
        mover[kept++] = i;
      } else {
        value[i] = target;
      }
    }
    if (kept == movers) {
      for (std::size_t n = 0; n < movers; ++n) {
        value[mover[n]] += step * sites.weight[mover[n]].value;
      }
      return;
    }
    movers = kept;
  }
}

// Rows of the sites that have weight here, taken where they have none yet.
SiteRows claim(const SitesAtHand& sites, YieldedSites& yielded) {
  SiteRows row;
  row.fill(-1);
  for (std::size_t i = 0; i < sites.count; ++i) {
    if (sites.weight[i].value > 0.0) {
      row[i] = claim_yielded(yielded, sites.site[i]);
    }
  }
  return row;
}

// Nothing in the table falls, whoever else has written there.
void write_yielded(const SitesAtHand& sites, const SiteRows& row,
                   YieldedSites& yielded) {
  for (std::size_t i = 0; i < sites.count; ++i) {
    if (row[i] >= 0) {
      YieldedSite& stayed = yielded.row[static_cast<std::size_t>(row[i])];
      stayed.dent_m = std::max(stayed.dent_m, sites.dent_m[i]);
      stayed.softened_m = std::max(stayed.softened_m, sites.softened_m[i]);
    }
  }
}

// The dents have other depths where the curves have softened.
void look_anew(RelaxingContact& contact) {
  for (int i = 0; i < contact.nodes.bundles; ++i) {
    BundleContact& b = contact.bundle[static_cast<std::size_t>(i)];
    b.solved = false;
    b.near_dent.high_m = b.near_dent.low_m;
    for (PlaceCubic& cubic : b.near_term) {
      cubic.high_m = cubic.low_m;
    }
  }
}

}  // namespace

bool yield(RelaxingContact& contact, SurfaceMemory& memory,
           const ElementCache& cache) noexcept {
  if (!contact.remembers || !contact.yielding.any) {
    return false;
  }
  // 1. What a first press to y would have left: D = r max(0, y - Y), and m = y.
  const Real y = contact.tool_m;
  const YieldingPlace before = contact.yielded;
  const Real dent_m = before.asked_dent_m(y);
  const bool deepens = dent_m > kThere * before.dent_m.value;
  const bool softens =
      y > contact.yielding.first_onset_m && y > kThere * before.softened_m.value;
  if (!deepens && !softens) {
    return false;
  }
  // 2. u before it. A tool that is lifted off leaves nothing.
  const RelaxedResponse held = response_of(contact, cache);
  if (!held.touched) {
    return false;
  }
  SitesAtHand& sites = contact.sites;
  const SiteValues dents_m = sites.dent_m;
  const SiteValues softened_m = sites.softened_m;
  // 3. Both are raised at the sites that have a row in the table.
  const SiteRows row = claim(sites, yielded_of(memory));
  if (deepens) {
    raise(sites, row, dent_m, sites.dent_m);
  }
  if (softens) {
    raise(sites, row, y, sites.softened_m);
    look_anew(contact);
  }
  read_yielded(contact);
  // 4. u after it, which falls by the proof in the header; a rise is rounding, and
  // undone.
  const RelaxedResponse eased = respond(contact, cache, y);
  if (eased.energy_j > held.energy_j) {
    sites.dent_m = dents_m;
    sites.softened_m = softened_m;
    read_yielded(contact);
    look_anew(contact);
    (void)respond(contact, cache, y);
    return false;
  }
  write_yielded(sites, row, yielded_of(memory));
  return true;
}

void take_yielded(RelaxingContact& contact, const SurfaceMemory& memory) noexcept {
  if (!contact.remembers || !contact.yielding.any) {
    return;
  }
  const SiteValues softened_m = contact.sites.softened_m;
  recall_yielded(contact.sites, memory);
  if (contact.sites.softened_m != softened_m) {
    look_anew(contact);
  }
  read_yielded(contact);
}

}  // namespace palpate
