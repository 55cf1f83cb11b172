#include "runtime/memory/sites_at_hand.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

// Less reach than this is none.
constexpr Real kNoReach = 1e-30;

// Position of a site, added if it is new.
std::size_t claim_position(SitesAtHand& sites, std::int32_t site) {
  const auto begin = sites.site.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(sites.count);
  const auto found = std::find(begin, end, site);
  if (found == end) {
    sites.share[sites.count].fill(Real(0.0));
    sites.site[sites.count] = site;
    return sites.count++;
  }
  return static_cast<std::size_t>(found - begin);
}

// What was at hand until now of a site: its position, or -1.
int position_in(const SitesAtHand& sites, std::int32_t site) {
  const auto begin = sites.site.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(sites.count);
  const auto found = std::find(begin, end, site);
  return found == end ? -1 : static_cast<int>(found - begin);
}

// What is remembered of a site at memory.time_s.
void recall(SitesAtHand& sites, std::size_t i, const SitesAtHand& until_now,
            const SurfaceMemory& memory) {
  const int before = position_in(until_now, sites.site[i]);
  const int row = before >= 0 ? -1 : find_site(memory, sites.site[i]);
  for (int b = 0; b < memory.bundles; ++b) {
    const auto bundle = static_cast<std::size_t>(b);
    TermValues& q = sites.relaxed_n[bundle][i];
    if (before >= 0) {
      q = until_now.relaxed_n[bundle][static_cast<std::size_t>(before)];
    } else if (row >= 0) {
      const MemorySite& stored = memory.row[static_cast<std::size_t>(row)];
      q = recovered(memory, relaxed_forces(memory, row, b), stored.relaxing,
                    static_cast<Real>(memory.time_s - stored.time_s));
    } else {
      q.setZero();
    }
  }
}

// What has stayed of a site.
void recall_yielded(SitesAtHand& sites, std::size_t i, const YieldedSites& yielded) {
  if (const int row = find_yielded(yielded, sites.site[i]); row >= 0) {
    const YieldedSite& stayed = yielded.row[static_cast<std::size_t>(row)];
    sites.dent_m[i] = stayed.dent_m;
    sites.softened_m[i] = stayed.softened_m;
  }
}

// Sites on one side of a target, of one term: their weights, and how far it is.
struct Movers {
  std::array<Real, kSitesAtHand> weight;
  std::array<Real, kSitesAtHand> way_n;
  std::array<Real*, kSitesAtHand> force_n;
  std::size_t count = 0;
};

// Those that would pass the target arrive there; the others share what is left.
void share_out(Movers& movers, Real target_n, Real missing_n) {
  while (movers.count > 0) {
    // Site i moves by kappa m_i way_i. The blend moves by kappa sum m_i^2 way_i, which
    // is to be missing_n. So kappa = missing_n / reach.
    Real reach = 0.0;
    Real heaviest = 0.0;
    for (std::size_t i = 0; i < movers.count; ++i) {
      reach += movers.weight[i] * movers.weight[i] * movers.way_n[i];
      heaviest = std::max(heaviest, movers.weight[i]);
    }
    const Real kappa = missing_n / reach;
    if (kappa * heaviest <= 1.0) {
      for (std::size_t i = 0; i < movers.count; ++i) {
        *movers.force_n[i] += kappa * movers.weight[i] * movers.way_n[i];
      }
      return;
    }
    // kappa m_i > 1 would pass the target. Such a site takes its whole way, m_i way_i
    // of what is missing; kappa of the others is larger then.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < movers.count; ++i) {
      if (kappa * movers.weight[i] <= 1.0) {
        movers.weight[kept] = movers.weight[i];
        movers.way_n[kept] = movers.way_n[i];
        movers.force_n[kept++] = movers.force_n[i];
      } else {
        missing_n -= movers.weight[i] * movers.way_n[i];
        *movers.force_n[i] = target_n;
      }
    }
    movers.count = kept;
  }
}

// The same of every term.
void share_out(SitesAtHand& sites, int bundle, Real target_n,
               const TermValues& missing_n) {
  for (Eigen::Index k = 0; k < missing_n.size(); ++k) {
    Movers movers;
    for (std::size_t i = 0; i < sites.count; ++i) {
      Real& q = sites.relaxed_n[static_cast<std::size_t>(bundle)][i](k);
      const Real w = sites.weight[i].value;
      if (w > 0.0 && (target_n - q) * missing_n(k) > 0.0) {
        movers.weight[movers.count] = w;
        movers.way_n[movers.count] = target_n - q;
        movers.force_n[movers.count++] = &q;
      }
    }
    share_out(movers, target_n, missing_n(k));
  }
}

}  // namespace

SitesAtHand sites_of(const Element& element, const SitesAtHand& until_now,
                     const SurfaceMemory& memory) noexcept {
  SitesAtHand sites;
  sites.time_s = memory.time_s;
  // m_ij: a site that several corners read stands once, with a share of each.
  for (std::size_t j = 0; j < 3; ++j) {
    const NodeMemory& node = element.memory.node[j];
    for (std::size_t n = 0; n < kNodeSites; ++n) {
      if (node.site[n] >= 0 && node.weight[n] > 0.0) {
        sites.share[claim_position(sites, node.site[n])][j] += node.weight[n];
      }
    }
    sites.corner_relaxing[j] = Eigen::Map<const TermValues>(node.relaxing.data());
  }
  sites.uniform = element.memory.node[0].relaxing == element.memory.node[1].relaxing &&
                  element.memory.node[0].relaxing == element.memory.node[2].relaxing;
  sites.place_relaxing.value = sites.corner_relaxing[0];
  for (std::size_t i = 0; i < sites.count; ++i) {
    const auto& share = sites.share[i];
    const auto& g = sites.corner_relaxing;
    // A site goes back alone with g_k, the mean of the corners' by their shares m_ij.
    sites.relaxing[i] = (share[0] * g[0] + share[1] * g[1] + share[2] * g[2]) /
                        (share[0] + share[1] + share[2]);
    recall(sites, i, until_now, memory);
    if (memory.yields) {
      recall_yielded(sites, i, yielded_of(memory));
    }
  }
  return sites;
}

void recall_yielded(SitesAtHand& sites, const SurfaceMemory& memory) noexcept {
  for (std::size_t i = 0; i < sites.count; ++i) {
    recall_yielded(sites, i, yielded_of(memory));
  }
}

void put_back(const SitesAtHand& sites, SurfaceMemory& memory) noexcept {
  for (std::size_t i = 0; i < sites.count; ++i) {
    Real most = 0.0;
    for (std::size_t b = 0; b < static_cast<std::size_t>(memory.bundles); ++b) {
      most = std::max(most, sites.relaxed_n[b][i].maxCoeff());
    }
    const int row = most > 0.0 ? claim_site(memory, sites.site[i])
                               : find_site(memory, sites.site[i]);
    if (row < 0) {
      continue;
    }
    MemorySite& stored = memory.row[static_cast<std::size_t>(row)];
    stored.time_s = sites.time_s;
    stored.relaxing = sites.relaxing[i];
    for (int b = 0; b < memory.bundles; ++b) {
      relaxed_forces(memory, row, b) = sites.relaxed_n[static_cast<std::size_t>(b)][i];
    }
  }
}

void catch_up(SitesAtHand& sites, const SurfaceMemory& memory) noexcept {
  const auto behind_s = static_cast<Real>(memory.time_s - sites.time_s);
  if (!(behind_s > 0.0)) {
    return;
  }
  for (std::size_t b = 0; b < static_cast<std::size_t>(memory.bundles); ++b) {
    for (std::size_t i = 0; i < sites.count; ++i) {
      TermValues& q = sites.relaxed_n[b][i];
      q = recovered(memory, q, sites.relaxing[i], behind_s);
    }
  }
  sites.time_s = memory.time_s;
}

void weigh(SitesAtHand& sites, const NodeValues& weight, const Turn& turn) noexcept {
  for (std::size_t i = 0; i < sites.count; ++i) {
    const auto& m = sites.share[i];
    sites.weight[i] = {m[0] * weight(0) + m[1] * weight(1) + m[2] * weight(2),
                       m[0] * turn(0, 0) + m[1] * turn(1, 0) + m[2] * turn(2, 0),
                       m[0] * turn(0, 1) + m[1] * turn(1, 1) + m[2] * turn(2, 1),
                       m[0] * turn(0, 2) + m[1] * turn(1, 2) + m[2] * turn(2, 2)};
  }
  if (sites.uniform) {
    return;
  }
  const auto& g = sites.corner_relaxing;
  Turned<TermValues>& at = sites.place_relaxing;
  at.value = weight(0) * g[0] + weight(1) * g[1] + weight(2) * g[2];
  at.by_1 = turn(0, 0) * g[0] + turn(1, 0) * g[1] + turn(2, 0) * g[2];
  at.by_2 = turn(0, 1) * g[0] + turn(1, 1) * g[1] + turn(2, 1) * g[2];
  at.by_3 = turn(0, 2) * g[0] + turn(1, 2) * g[1] + turn(2, 2) * g[2];
}

BlendedMemory blended(const SitesAtHand& sites, int bundle) noexcept {
  BlendedMemory at;
  Turned<TermValues>& sum = at.relaxed_n;
  const auto& forces = sites.relaxed_n[static_cast<std::size_t>(bundle)];
  for (std::size_t i = 0; i < sites.count; ++i) {
    const Turned<Real>& m = sites.weight[i];
    sum.value += m.value * forces[i];
    sum.by_1 += m.by_1 * forces[i];
    sum.by_2 += m.by_2 * forces[i];
    sum.by_3 += m.by_3 * forces[i];
  }
  at.carried_n = carried_n(sites, sum.value);
  return at;
}

Turned<Real> blended(const SitesAtHand& sites,
                     const std::array<Real, kSitesAtHand>& value) noexcept {
  Turned<Real> sum{0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < sites.count; ++i) {
    const Turned<Real>& m = sites.weight[i];
    sum.value += m.value * value[i];
    sum.by_1 += m.by_1 * value[i];
    sum.by_2 += m.by_2 * value[i];
    sum.by_3 += m.by_3 * value[i];
  }
  return sum;
}

void move_towards(SitesAtHand& sites, int bundle, const TermValues& from_n,
                  Real target_n, const TermValues& share,
                  Turned<TermValues>& blend) noexcept {
  auto& forces = sites.relaxed_n[static_cast<std::size_t>(bundle)];
  const TermValues missing = share * (target_n - from_n);
  TermValues side;
  for (Eigen::Index k = 0; k < side.size(); ++k) {
    side(k) = missing(k) < 0.0 ? Real(-1.0) : Real(1.0);
  }
  // How far each site is from the target, on this side of it; else 0.
  std::array<TermValues, kSitesAtHand> way_n;
  TermValues reach = TermValues::Constant(kNoReach);
  Real heaviest = 0.0;
  for (std::size_t i = 0; i < sites.count; ++i) {
    const Real w = sites.weight[i].value;
    way_n[i] = (side * (target_n - forces[i])).max(Real(0.0));
    reach += (w * w) * way_n[i];
    heaviest = std::max(heaviest, w);
  }
  const TermValues kappa = missing / reach;  // signed
  if (!(heaviest * kappa.abs().maxCoeff() <= 1.0)) [[unlikely]] {
    share_out(sites, bundle, target_n, missing);
    const TermValues value = blend.value;
    blend = blended(sites, bundle).relaxed_n;
    blend.value = value;
    return;
  }
  for (std::size_t i = 0; i < sites.count; ++i) {
    const Turned<Real>& m = sites.weight[i];
    const TermValues step = (m.value * kappa) * way_n[i];
    forces[i] += step;
    blend.by_1 += m.by_1 * step;
    blend.by_2 += m.by_2 * step;
    blend.by_3 += m.by_3 * step;
  }
}

}  // namespace palpate
