#include "runtime/fast/relaxing_contact.h"

#include <algorithm>
#include <cstddef>

namespace palpate {
namespace {

// What a plain curve that falls has beside its running maximum, of one node.
ElementSample fallen(const RelaxingContact& contact, const ElementCache& cache,
                     std::size_t j) {
  const Real e = contact.nodes.lean[j] * (contact.depth_m - contact.nodes.touch_m[j]);
  if (!contact.nodes.falls[j] || !(e > 0.0)) {
    return {};
  }
  const ElementCurve curve =
      cache.element[static_cast<std::size_t>(contact.slot)].node[j].curve();
  const ElementSample own = curve.at(e);
  const ElementSample rising = rising_piece_around(curve, e).at(e);
  return {own.force_n - rising.force_n,
          own.stiffness_n_per_m - rising.stiffness_n_per_m,
          own.energy_j - rising.energy_j, own.extrapolated};
}

void add_fallen(const RelaxingContact& contact, const ElementCache& cache,
                RelaxedResponse& response) {
  for (std::size_t j = 0; j < 3; ++j) {
    const Real w = contact.weight(static_cast<Eigen::Index>(j));
    const Real c = contact.nodes.lean[j];
    const ElementSample less = fallen(contact, cache, j);
    response.force_n += w * c * less.force_n;
    response.stiffness_n_per_m += w * c * c * less.stiffness_n_per_m;
    response.energy_j += w * less.energy_j;
  }
}

}  // namespace

void enter(RelaxingContact& contact, const SurfaceMemory& memory,
           const ElementCache& cache, int slot, const PlaceNodes& nodes) noexcept {
  const Element& element = cache.element[static_cast<std::size_t>(slot)];
  catch_up(contact.sites, memory);
  contact.slot = slot;
  contact.stored_at = cache.stored_at[static_cast<std::size_t>(slot)];
  contact.nodes = nodes;
  contact.sites = element.memory.terms > 0 && agrees(memory, element.memory)
                      ? sites_of(element, contact.sites, memory)
                      : SitesAtHand{};
  for (std::size_t b = 0; b < static_cast<std::size_t>(nodes.bundles); ++b) {
    contact.bundle[b].contact_pieces = {};
    contact.bundle[b].dent_pieces = {};
    contact.bundle[b].term_pieces = {};
  }
}

void read_memory(RelaxingContact& contact, const SurfaceMemory& memory,
                 const NodeValues& weight, const Turn& turn) noexcept {
  contact.weight = weight;
  contact.turn = turn;
  catch_up(contact.sites, memory);
  weigh(contact.sites, weight, turn);
  for (int b = 0; b < memory.bundles; ++b) {
    BundleContact& bundle = contact.bundle[static_cast<std::size_t>(b)];
    bundle.memory = blended(contact.sites, b);
    bundle.solved = false;
    bundle.near_dent.high_m = bundle.near_dent.low_m;
  }
}

CarriedMemory carried_memory(const RelaxingContact& contact) noexcept {
  CarriedMemory carried;
  if (contact.remembers) {
    carried.bundles = contact.nodes.bundles;
    for (std::size_t b = 0; b < static_cast<std::size_t>(carried.bundles); ++b) {
      carried.carried_n[b] = contact.bundle[b].memory.carried_n;
      carried.dent_m[b] = contact.bundle[b].dent.depth_m;
    }
  }
  return carried;
}

Real carried_n(const RelaxingContact& contact) noexcept {
  Real carried = 0.0;
  if (contact.remembers) {
    for (int b = 0; b < contact.nodes.bundles; ++b) {
      carried += contact.bundle[static_cast<std::size_t>(b)].memory.carried_n;
    }
  }
  return carried;
}

void continue_at(RelaxingContact& contact, const CarriedMemory& carried,
                 const NodeValues& weight) noexcept {
  contact.remembers = true;
  contact.weight = weight;
  for (std::size_t b = 0; b < static_cast<std::size_t>(carried.bundles); ++b) {
    contact.bundle[b].memory.carried_n = carried.carried_n[b];
    contact.bundle[b].dent.depth_m = carried.dent_m[b];
  }
}

RelaxedResponse respond(RelaxingContact& contact, const ElementCache& cache,
                        Real y_m) noexcept {
  contact.depth_m = y_m;
  const PlaceCurve curve = curve_of(contact, cache);
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    BundleContact& bundle = contact.bundle[static_cast<std::size_t>(b)];
    bundle.at = point_at(curve, b, y_m, bundle.contact_pieces);
  }
  return response_of(contact, cache);
}

RelaxedResponse response_of(RelaxingContact& contact,
                            const ElementCache& cache) noexcept {
  RelaxedResponse response;
  for (int i = 0; i < contact.nodes.bundles; ++i) {
    response.energy_j += set_energy(contact, cache, i);
    const BundleContact& b = contact.bundle[static_cast<std::size_t>(i)];
    response.extrapolated = response.extrapolated || b.at.extrapolated;
    if (b.touched) {
      response.touched = true;
      response.force_n += b.at.force_n - b.memory.carried_n;
      response.stiffness_n_per_m += b.at.stiffness_n_per_m;
    }
  }
  if (contact.nodes.any_falls) {
    add_fallen(contact, cache, response);
  }
  return response;
}

Vector2 surface_slope_j(RelaxingContact& contact, const ElementCache& cache) noexcept {
  NodeValues energy = NodeValues::Zero();
  Vector2 slope = Vector2::Zero();
  const PlaceCurve curve = curve_of(contact, cache);
  for (int i = 0; i < contact.nodes.bundles; ++i) {
    BundleContact& b = contact.bundle[static_cast<std::size_t>(i)];
    if (b.touched) {
      energy += b.at.node_j - point_at(curve, i, b.dent.depth_m, b.dent_pieces).node_j;
      slope -=
          (contact.depth_m - b.dent.depth_m) * carried_slope_n(contact.sites, b.memory);
    }
  }
  for (std::size_t j = 0; contact.nodes.any_falls && j < 3; ++j) {
    energy(static_cast<Eigen::Index>(j)) += fallen(contact, cache, j).energy_j;
  }
  return slope + contact.turn.transpose() * energy.head<3>().matrix();
}

bool touches(const RelaxingContact& contact, const ElementCache& cache,
             Real y_m) noexcept {
  NodePieces pieces;
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    if (point_at(curve_of(contact, cache), b, y_m, pieces).force_n >
        contact.bundle[static_cast<std::size_t>(b)].memory.carried_n) {
      return true;
    }
  }
  return false;
}

}  // namespace palpate
