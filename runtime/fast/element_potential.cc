#include "runtime/fast/element_potential.h"

namespace palpate {
namespace {

// The normal part of a static response at depth d.
void add_normal(const ElementModel& model, const Element& element, Real d,
                CurvePieces& pieces, ElementResponse& response) {
  for (std::size_t j = 0; j < 3; ++j) {
    const Real weight = model.area(static_cast<Eigen::Index>(j));
    const ElementNode& node = element.node[j];
    if (!(weight > 0.0) || node.samples == 0) {
      continue;
    }
    const Real d_j = d - model.touch_m[j] - model.shift_m;
    response.touching = response.touching || d_j + model.shift_m > 0.0;
    if (d_j > 0.0) {
      const ElementSample at = evaluate(pieces, node, j, d_j);
      response.loaded = true;
      response.normal_n += weight * at.force_n;
      response.stiffness_n_per_m += weight * at.stiffness_n_per_m;
      response.normal_j += weight * at.energy_j;
      response.extrapolated = response.extrapolated || at.extrapolated;
    }
  }
}

// The same of a surface that remembers.
void add_relaxed(const ElementModel& model, const ElementCache& cache, Real d,
                 RelaxingContact& contact, ElementResponse& response) {
  const RelaxedResponse at = respond(contact, cache, d - model.shift_m);
  response.loaded = at.touched;
  response.touching = at.touched || (model.shift_m > 0.0 && touches(contact, cache, d));
  response.extrapolated = at.extrapolated;
  response.normal_n = at.force_n;
  response.stiffness_n_per_m = at.stiffness_n_per_m;
  response.normal_j = at.energy_j;
}

// @param contact null: the surface is static.
ElementResponse response_by(const ElementModel& model, const ElementCache& cache,
                            const Vector3& x, CurvePieces& pieces,
                            RelaxingContact* contact) {
  ElementResponse response;
  if (model.slot < 0) {
    return response;
  }
  turn_to(pieces, cache, model.slot);
  const Vector3& u = model.direction;
  const Vector3 offset = model.rest_m - x;
  response.depth_m = offset.dot(u);
  if (contact != nullptr) {
    add_relaxed(model, cache, response.depth_m, *contact, response);
  } else {
    add_normal(model, cache.element[static_cast<std::size_t>(model.slot)],
               response.depth_m, pieces, response);
  }
  const Vector3 deflection = -offset - model.slip_m;
  response.presliding_m = deflection - deflection.dot(u) * u;
  response.friction_j =
      0.5 * model.friction_n_per_m * response.presliding_m.squaredNorm();
  return response;
}

}  // namespace

ElementResponse respond_here(ElementModel& model, const ElementCache& cache,
                             const Vector3& x_m) noexcept {
  return response_by(model, cache, x_m, model.pieces,
                     model.contact.remembers ? &model.contact : nullptr);
}

ElementResponse respond(const ElementModel& model, const ElementCache& cache,
                        const Vector3& x_m) noexcept {
  CurvePieces pieces = model.pieces;
  if (!model.contact.remembers) {
    return response_by(model, cache, x_m, pieces, nullptr);
  }
  RelaxingContact contact = model.contact;
  return response_by(model, cache, x_m, pieces, &contact);
}

void read_memory(ElementModel& model, const SurfaceMemory& memory, SurfaceMemory* keep,
                 const ElementCache& cache) noexcept {
  RelaxingContact& contact = model.contact;
  contact.remembers = false;
  if (!remembers(memory) || model.slot < 0) {
    return;
  }
  if (!is_in(contact, cache, model.slot)) {
    if (keep != nullptr) {
      put_back(contact.sites, *keep);
    }
    const Element& element = cache.element[static_cast<std::size_t>(model.slot)];
    enter(contact, memory, cache, model.slot,
          make_place_nodes(element, {1.0, 1.0, 1.0}, model.touch_m));
  }
  contact.remembers = contact.sites.count > 0;
  if (contact.remembers) {
    const Vector3& w = model.area;
    read_memory(contact, memory, {w(0), w(1), w(2), 0.0}, Turn::Zero());
  }
}

Vector3 force_n(const ElementModel& model, const ElementResponse& response) noexcept {
  return response.normal_n * model.direction -
         model.friction_n_per_m * response.presliding_m;
}

}  // namespace palpate
