#include "runtime/memory/relaxing_contact.h"

#include <algorithm>
#include <cstddef>

namespace palpate {
namespace {

// What a plain curve that falls has beside its running maximum, of one node, at a depth
// of the curve.
ElementSample fallen(const RelaxingContact& contact, const ElementCache& cache,
                     std::size_t j, Real depth_m) {
  const Real e = contact.nodes.lean[j] * (depth_m - contact.nodes.touch_m[j]);
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
  const Real r = contact.yielded.share_at(contact.depth_m);
  for (std::size_t j = 0; j < 3; ++j) {
    const Real w = contact.weight(static_cast<Eigen::Index>(j));
    const Real c = contact.nodes.lean[j];
    const ElementSample less = fallen(contact, cache, j, contact.depth_m);
    response.force_n += w * c * less.force_n;
    response.stiffness_n_per_m += w * c * c * less.stiffness_n_per_m;
    response.energy_j += w * (Real(1.0) - r) * less.energy_j;
    if (r > 0.0) {
      response.energy_j +=
          w * r * fallen(contact, cache, j, contact.yielded.yield_m.value).energy_j;
    }
  }
}

// The same at one depth of the curve, for all nodes.
PlacePoint fallen_point(const RelaxingContact& contact, const ElementCache& cache,
                        Real depth_m) {
  PlacePoint point;
  for (std::size_t j = 0; j < 3; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const ElementSample less = fallen(contact, cache, j, depth_m);
    point.force_n += contact.weight(row) * contact.nodes.lean[j] * less.force_n;
    point.energy_j += contact.weight(row) * less.energy_j;
    point.node_j(row) = less.energy_j;
  }
  return point;
}

// Derivatives of u by the place where the surface yields [J], of one bundle. At fixed
// e, and with it -p_e dD; the dent's depth gives no part, p = s there.
Vector3 yielded_slope_j(RelaxingContact& contact, const PlaceCurve& curve, int bundle) {
  BundleContact& b = contact.bundle[static_cast<std::size_t>(bundle)];
  const YieldingPlace& place = contact.yielded;
  const Real s = b.memory.carried_n;
  Vector3 slope =
      stored_slope_j(place, b.at, b.at_yield, contact.depth_m, contact.turn) -
      (b.at.force_n - s) * slope_of(place.dent_m);
  if (s > 0.0) {  // else U_e(delta) is zero all around
    const PlacePoint at_dent = point_at(curve, bundle, b.dent.depth_m, b.dent_pieces);
    const Real above =
        place.elastic_depth_m(contact.depth_m) - place.elastic_depth_m(b.dent.depth_m);
    slope -= stored_slope_j(place, at_dent, b.at_yield, b.dent.depth_m, contact.turn) +
             above * carried_slope_n(contact.sites, b.memory);
  }
  return slope;
}

// The whole slope where the surface yields.
Vector3 yielded_slope_j(RelaxingContact& contact, const ElementCache& cache) {
  const PlaceCurve curve = curve_of(contact, cache);
  Vector3 slope = Vector3::Zero();
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    if (contact.bundle[static_cast<std::size_t>(b)].touched) {
      slope += yielded_slope_j(contact, curve, b);
    }
  }
  if (contact.nodes.any_falls) {
    const PlacePoint at = fallen_point(contact, cache, contact.depth_m);
    slope += stored_slope_j(contact.yielded, at,
                            fallen_point(contact, cache, contact.yielded.yield_m.value),
                            contact.depth_m, contact.turn) -
             at.force_n * slope_of(contact.yielded.dent_m);
  }
  return slope;
}

}  // namespace

void enter(RelaxingContact& contact, const SurfaceMemory& memory,
           const ElementCache& cache, int slot, const PlaceNodes& nodes) noexcept {
  const Element& element = cache.element[static_cast<std::size_t>(slot)];
  catch_up(contact.sites, memory);
  contact.slot = slot;
  contact.stored_at = cache.stored_at[static_cast<std::size_t>(slot)];
  contact.nodes = nodes;
  const bool remembered = element.memory.terms > 0 || element.memory.yields;
  contact.sites = remembered && agrees(memory, element.memory)
                      ? sites_of(element, contact.sites, memory)
                      : SitesAtHand{};
  contact.yielding = make_yielding_nodes(element.memory, nodes);
  contact.yielded = {};
  for (std::size_t b = 0; b < static_cast<std::size_t>(nodes.bundles); ++b) {
    contact.bundle[b].contact_pieces = {};
    contact.bundle[b].dent_pieces = {};
    contact.bundle[b].term_pieces = {};
    contact.bundle[b].yield_pieces = {};
  }
}

void read_memory(RelaxingContact& contact, const SurfaceMemory& memory,
                 const NodeValues& weight, const Turn& turn) noexcept {
  contact.place_weight = contact.weight = weight;
  contact.place_turn = contact.turn = turn;
  catch_up(contact.sites, memory);
  weigh(contact.sites, weight, turn);
  if (contact.yielding.any) {
    locate(contact.yielded, contact.yielding, weight, turn);
    read_yielded(contact);
  }
  for (int b = 0; b < memory.bundles; ++b) {
    BundleContact& bundle = contact.bundle[static_cast<std::size_t>(b)];
    if (memory.times.terms > 0) {
      bundle.memory = blended(contact.sites, b);
    }
    bundle.solved = false;
    bundle.near_dent.high_m = bundle.near_dent.low_m;
  }
}

void read_yielded(RelaxingContact& contact) noexcept {
  contact.yielded.dent_m = blended(contact.sites, contact.sites.dent_m);
  contact.yielded.softened_m = blended(contact.sites, contact.sites.softened_m);
  contact.weight = contact.place_weight;
  contact.turn = contact.place_turn;
  soften(contact.yielded, contact.yielding, contact.weight, contact.turn);
}

CarriedMemory carried_memory(const RelaxingContact& contact) noexcept {
  CarriedMemory carried;
  if (contact.remembers) {
    carried.bundles = contact.nodes.bundles;
    for (std::size_t b = 0; b < static_cast<std::size_t>(carried.bundles); ++b) {
      carried.carried_n[b] = contact.bundle[b].memory.carried_n;
      carried.dent_m[b] = contact.bundle[b].dent.depth_m;
    }
    carried.weight = contact.weight;
    carried.yielded = contact.yielded;
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

void continue_at(RelaxingContact& contact, const CarriedMemory& carried) noexcept {
  contact.remembers = true;
  contact.weight = carried.weight;
  contact.yielded = carried.yielded;
  for (std::size_t b = 0; b < static_cast<std::size_t>(carried.bundles); ++b) {
    contact.bundle[b].memory.carried_n = carried.carried_n[b];
    contact.bundle[b].dent.depth_m = carried.dent_m[b];
  }
}

RelaxedResponse respond(RelaxingContact& contact, const ElementCache& cache,
                        Real y_m) noexcept {
  contact.tool_m = contact.depth_m = y_m;
  if (contact.yielding.any) {
    contact.depth_m = contact.yielded.curve_depth_m(y_m);
  }
  const PlaceCurve curve = curve_of(contact, cache);
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    BundleContact& bundle = contact.bundle[static_cast<std::size_t>(b)];
    bundle.at = point_at(curve, b, contact.depth_m, bundle.contact_pieces);
    if (contact.yielding.any) {
      bundle.at_yield =
          point_at(curve, b, contact.yielded.yield_m.value, bundle.yield_pieces);
    }
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
  if (contact.depth_m > contact.yielded.yield_m.value) {
    response.stiffness_n_per_m *= contact.yielded.stretch;
  }
  return response;
}

Vector3 surface_slope_j(RelaxingContact& contact, const ElementCache& cache) noexcept {
  if (contact.yielding.any) {
    return yielded_slope_j(contact, cache);
  }
  NodeValues energy = NodeValues::Zero();
  Vector3 slope = Vector3::Zero();
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
    energy(static_cast<Eigen::Index>(j)) +=
        fallen(contact, cache, j, contact.depth_m).energy_j;
  }
  return slope + contact.turn.transpose() * energy.head<3>().matrix();
}

bool touches(const RelaxingContact& contact, const ElementCache& cache,
             Real y_m) noexcept {
  NodePieces pieces;
  const Real depth_m = contact.yielded.curve_depth_m(y_m);
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    if (point_at(curve_of(contact, cache), b, depth_m, pieces).force_n >
        contact.bundle[static_cast<std::size_t>(b)].memory.carried_n) {
      return true;
    }
  }
  return false;
}

}  // namespace palpate
