#include "runtime/fast/potential_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "runtime/element/triangle.h"

namespace palpate {
namespace {

// c_j: how far the tool moves along u for each unit along the normal.
Real lean(const ElementNode& node) {
  const Eigen::Map<const Vector3> n(node.normal.data());
  const Eigen::Map<const Vector3> u(node.direction.data());
  return std::abs(n.dot(u));
}

}  // namespace

FieldResponse respond(const FieldPlace& place, const ElementCache& cache,
                      Real tool_radius_m, Real shift_m, CurvePieces& pieces) noexcept {
  FieldResponse response;
  if (place.slot < 0) {
    return response;
  }
  turn_to(pieces, cache, place.slot);
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  response.depth_m = tool_radius_m - place.height_m;
  Vector3 slope = Vector3::Zero();  // dU by the place, s held [J]
  for (std::size_t j = 0; j < 3; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const ElementNode& node = element.node[j];
    if (node.samples == 0) {
      continue;
    }
    const Real weight = std::max(0.0, place.weight(row));
    const Real past = response.depth_m - node.touch_offset_m;
    response.touching = response.touching || (past > 0.0 && weight > 0.0);
    if (!(past - shift_m > 0.0)) {
      continue;
    }
    const Real c = lean(node);
    const ElementSample at = evaluate(pieces, node, j, c * (past - shift_m));
    response.loaded = response.loaded || weight > 0.0;
    response.extrapolated = response.extrapolated || (at.extrapolated && weight > 0.0);
    response.normal_n += weight * c * at.force_n;
    response.stiffness_n_per_m += weight * c * c * at.stiffness_n_per_m;
    response.energy_j += weight * at.energy_j;
    slope += place.turn.row(row).transpose() * at.energy_j;
  }
  if (place.folded) {
    response.force_n = response.normal_n * place.normal;
  } else if (response.loaded) {
    response.force_n = -gradient(place, slope, -response.normal_n);
  }
  return response;
}

PlaceNodes place_nodes(const FieldPlace& place, const ElementCache& cache) noexcept {
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  std::array<Real, 3> leans{};
  std::array<Real, 3> touch_m{};
  for (std::size_t j = 0; j < 3; ++j) {
    leans[j] = lean(element.node[j]);
    touch_m[j] = element.node[j].touch_offset_m;
  }
  return make_place_nodes(element, leans, touch_m);
}

Vector3 shares_of(const FieldPlace& place, const Vector3& point_m) noexcept {
  const Matrix3& corners_m = place.prism.corner_m;
  return place.kind == FieldKind::kFacets
             ? place.weight
             : triangle::nearest_inside(corners_m,
                                        triangle::area_coordinates(corners_m, point_m));
}

NodeValues node_weights(const FieldPlace& place) noexcept {
  const Vector3& w = place.weight;
  return {std::max(Real(0.0), w(0)), std::max(Real(0.0), w(1)),
          std::max(Real(0.0), w(2)), Real(0.0)};
}

void read_memory(RelaxingContact& contact, const SurfaceMemory& memory,
                 SurfaceMemory* keep, const FieldPlace& place,
                 const ElementCache& cache, Real tool_radius_m) noexcept {
  contact.remembers = false;
  if (!remembers(memory) || place.slot < 0) {
    return;
  }
  if (!is_in(contact, cache, place.slot)) {
    if (keep != nullptr) {
      put_back(contact.sites, *keep);
    }
    enter(contact, memory, cache, place.slot, place_nodes(place, cache));
  }
  contact.remembers = !is_above(contact, tool_radius_m - place.height_m);
  if (contact.remembers) {
    read_memory(contact, memory, node_weights(place), place.turn);
  }
}

FieldResponse field_response(const FieldPlace& place, const ElementCache& cache,
                             Real tool_radius_m, Real shift_m,
                             const RelaxingContact& contact,
                             const RelaxedResponse& relaxed) noexcept {
  FieldResponse response;
  response.depth_m = tool_radius_m - place.height_m;
  response.loaded = relaxed.touched;
  response.touching =
      relaxed.touched || (shift_m > 0.0 && touches(contact, cache, response.depth_m));
  response.extrapolated = relaxed.extrapolated;
  response.normal_n = relaxed.force_n;
  response.stiffness_n_per_m = relaxed.stiffness_n_per_m;
  response.energy_j = relaxed.energy_j;
  response.force_n = relaxed.force_n * place.rise;
  return response;
}

Vector3 whole_force_n(const FieldPlace& place, const ElementCache& cache,
                      RelaxingContact& contact,
                      const FieldResponse& response) noexcept {
  if (place.folded || response.normal_n == 0.0) {
    return response.force_n;
  }
  return -gradient(place, surface_slope_j(contact, cache), -response.normal_n);
}

FieldResponse respond(const FieldPlace& place, const ElementCache& cache,
                      Real tool_radius_m, Real shift_m,
                      RelaxingContact& contact) noexcept {
  const Real y = tool_radius_m - place.height_m - shift_m;
  return field_response(place, cache, tool_radius_m, shift_m, contact,
                        respond(contact, cache, y));
}

Real unloading_shift_m(const FieldPlace& place, const ElementCache& cache,
                       Real tool_radius_m) noexcept {
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  Real touch = std::numeric_limits<Real>::infinity();
  for (std::size_t j = 0; j < 3; ++j) {
    if (element.node[j].samples > 0) {
      touch = std::min(touch, element.node[j].touch_offset_m);
    }
  }
  return std::isfinite(touch) ? std::max(0.0, tool_radius_m - place.height_m - touch)
                              : 0.0;
}

}  // namespace palpate
