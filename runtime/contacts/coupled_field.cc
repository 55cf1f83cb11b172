#include "runtime/contacts/coupled_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "runtime/contacts/coupled_compliance.h"
#include "runtime/fast/potential_field.h"

namespace palpate {
namespace {

using Index = Eigen::Index;

// Depth of a contact that has no element: of nothing.
constexpr Real kNowhereM = -1.0;

const Element& element_at(const CoupledSurface& surface, int slot) {
  return surface.cache.element[static_cast<std::size_t>(slot)];
}

struct NodeReading {
  ElementSample sample;
  Real past_m = 0.0;
};

// The piece of node a's curve around y, which is past its touch.
const CurvePiece& piece_of(CoupledPlace& at, const CoupledSurface& surface,
                           std::size_t a, Real along_m) {
  CurvePiece& piece = at.pieces.node[a];
  if (!piece.holds(along_m)) {
    piece = piece_around(element_at(surface, at.slot).node[a].curve(), along_m);
  }
  return piece;
}

// Node a at depth y of the contact.
NodeReading read_node(CoupledPlace& at, const CoupledSurface& surface, std::size_t a,
                      Real y) {
  NodeReading reading{{}, y - at.touch_m[a]};
  if (at.lean[a] > 0.0 && reading.past_m > 0.0) {
    const Real along = at.lean[a] * reading.past_m;
    reading.sample = piece_of(at, surface, a, along).at(along);
  }
  return reading;
}

// The stored curve of a contact at delta: its energy, or force and stiffness.
Real energy_at(CoupledPlace& at, const CoupledSurface& surface, Real y) {
  // E_i(y) = sum_a n_a E_a(c_a (y - t_a)); a node counts past its touch t_a.
  Real energy = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (at.lean[a] > 0.0 && y > at.touch_m[a]) {
      const Real along = at.lean[a] * (y - at.touch_m[a]);
      energy +=
          weight_of(at.place, a) * piece_of(at, surface, a, along).at(along).energy_j;
    }
  }
  return energy;
}

void force_and_stiffness_at(CoupledPlace& at, const CoupledSurface& surface, Real y,
                            Real& force, Real& stiffness) {
  // f_i = sum_a n_a c_a f_a and k_i = sum_a n_a c_a^2 f_a' at c_a (y - t_a), by
  // Horner's rule in the cubic around.
  force = 0.0;
  stiffness = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (at.lean[a] > 0.0 && y > at.touch_m[a]) {
      const Real along = at.lean[a] * (y - at.touch_m[a]);
      const CurvePiece& p = piece_of(at, surface, a, along);
      const Real x = along - p.from_m;
      const Real weight = weight_of(at.place, a) * at.lean[a];
      force +=
          weight * (p.force_n + x * (p.stiffness_n_per_m +
                                     x * (p.bend_n_per_m2 + x * p.twist_n_per_m3)));
      stiffness += weight * at.lean[a] *
                   (p.stiffness_n_per_m +
                    x * (2.0 * p.bend_n_per_m2 + x * (3.0 * p.twist_n_per_m3)));
    }
  }
}

struct Curves {
  CoupledField* field;
  CoupledSurfaces surfaces;
};

bool has_memory(const CoupledField& field, std::size_t i) {
  return field.remembers && field.memory[i].remembers;
}

void evaluate_remembered(RelaxingContact& contact, const CoupledSurface& surface,
                         CoupledContacts& c, Index i, bool energy) {
  const RelaxedResponse at = respond(contact, surface.cache, c.delta_m(i));
  if (energy) {
    c.own_energy_j(i) = at.energy_j;
  } else {
    c.force_n(i) = at.force_n;
    c.stiffness_n_per_m(i) = at.stiffness_n_per_m;
  }
}

// The stored curves of all contacts at their delta.
void evaluate_curves(void* of, CoupledContacts& c, bool energy) {
  const auto& [field, surfaces] = *static_cast<Curves*>(of);
  for (Index i = 0; i < c.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (has_memory(*field, self)) {
      evaluate_remembered(field->memory[self], surfaces[i], c, i, energy);
      continue;
    }
    CoupledPlace& at = field->at[self];
    const Real y = at.slot >= 0 ? c.delta_m(i) : -std::numeric_limits<Real>::max();
    if (energy) {
      c.own_energy_j(i) = energy_at(at, surfaces[i], y);
    } else {
      force_and_stiffness_at(at, surfaces[i], y, c.force_n(i), c.stiffness_n_per_m(i));
    }
  }
}

// Derivatives of s_i by the place's coordinates [N].
Vector3 relaxed_slope_n(const RelaxingContact& contact) {
  Vector3 slope = Vector3::Zero();
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    slope += carried_slope_n(contact.sites,
                             contact.bundle[static_cast<std::size_t>(b)].memory);
  }
  return slope;
}

// What the energy changes by with place i along the surface [J], but for that of its
// own curve.
Vector3 coupling_slope_j(const CoupledField& field, const CoupledSet& set,
                         CoupledSurfaces surfaces, std::size_t i) {
  const CoupledContacts& c = field.equilibrium;
  const auto self = static_cast<Index>(i);
  if (!field.remembers) {
    return -c.force_n(self) * sunk_slope_m(field, set, surfaces, i, c.force_n);
  }
  const Real s = field.carried_n(self);
  ContactValues borne;
  borne.head(set.count) = c.force_n.head(set.count) + field.carried_n.head(set.count);
  Vector3 slope = -borne(self) * sunk_slope_m(field, set, surfaces, i, borne);
  if (s > 0.0) {
    slope += s * sunk_slope_m(field, set, surfaces, i, field.carried_n) -
             c.dimple_m(self) * relaxed_slope_n(field.memory[i]);
  }
  return slope;
}

// Reads what the surfaces remember at the places.
void read_memories(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
                   Keep keep) {
  field.remembers = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(set.count); ++i) {
    SurfaceMemory& memory = surfaces[i].memory;
    RelaxingContact& contact = field.memory[i];
    // Of a radius without end: dents matter to others wherever the contact is.
    read_memory(contact, memory, keep == Keep::kYes ? &memory : nullptr,
                field.at[i].place, surfaces[i].cache,
                std::numeric_limits<Real>::infinity());
    field.remembers = field.remembers || contact.remembers;
  }
  if (field.remembers) {
    take_relaxed(field, set);
  } else {
    field.equilibrium.sunk_m.head(set.count).setZero();
  }
}

}  // namespace

bool store(CoupledSurface& surface, const ContactElement& message) noexcept {
  float sum = 0.0F;
  for (const ContactRow& row : message.row) {
    for (const float value : row.value) {
      sum += 0.0F * value;
    }
    for (const float value : row.mode) {
      sum += 0.0F * value;
    }
  }
  if (!(sum == 0.0F) || !store(surface.cache, message.element)) {
    return false;
  }
  const int slot = find(surface.cache, message.element.triangle);
  surface.row[static_cast<std::size_t>(slot)] = message.row;
  take_terms(surface.memory, message.element.memory);
  return true;
}

void enter(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
           int i) noexcept {
  const auto self = static_cast<std::size_t>(i);
  CoupledPlace& at = field.at[self];
  // What depends on the element alone is read once, until another element or another
  // copy of this one is in use.
  const int slot = at.place.slot;
  const CoupledSurface& surface = surfaces[i];
  const std::uint64_t stored_at =
      slot < 0 ? 0 : surface.cache.stored_at[static_cast<std::size_t>(slot)];
  if (slot == at.slot && stored_at == at.stored_at) {
    return;
  }
  at.slot = slot;
  at.stored_at = stored_at;
  if (slot < 0) {
    return;
  }
  turn_to(at.pieces, surface.cache, slot);
  const Element& element = element_at(surface, slot);
  const auto& row = surface.row[static_cast<std::size_t>(slot)];
  for (std::size_t a = 0; a < 3; ++a) {
    const ElementNode& node = element.node[a];
    const Eigen::Map<const Vector3> n(node.normal.data());
    const Eigen::Map<const Vector3> u(node.direction.data());
    // c_a = |n . u| turns a depth along the normal into a deflection; t_a is along the
    // normal.
    at.lean[a] = node.samples > 0 ? std::abs(n.dot(u)) : Real(0.0);
    at.touch_m[a] = node.touch_offset_m;
    // s_m b_m with s_m = 1 of the added modes, -1 of the others.
    for (int m = 0; m < set.modes; ++m) {
      const auto b = static_cast<Real>(row[a].mode[static_cast<std::size_t>(m)]);
      at.signed_mode(m, static_cast<Index>(a)) = m < set.added_modes ? b : -b;
    }
    for (std::size_t j = 0; j < static_cast<std::size_t>(set.count); ++j) {
      // c_a(r_ij) at the fixed distance r_ij; between two ports the distance changes
      // with every tick.
      const bool couples = j != self && of_one_port(set, self, j);
      at.reach(static_cast<Index>(j), static_cast<Index>(a)) =
          couples ? reach_m_per_n(row[a], set.apart[self][j]) : Real(0.0);
    }
  }
}

void set_places(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
                Keep keep) noexcept {
  CoupledContacts& c = field.equilibrium;
  c.count = set.count;
  for (Index i = 0; i < set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const CoupledPlace& at = field.at[self];
    c.depth_m(i) = at.slot < 0
                       ? kNowhereM
                       : set.sphere[self].radius_m - at.place.height_m - field.shift_m;
  }
  couple_places(field, set, surfaces);
  read_memories(field, set, surfaces, keep);
}

void take_relaxed(CoupledField& field, const CoupledSet& set) noexcept {
  for (Index i = 0; i < set.count; ++i) {
    field.carried_n(i) = carried_n(field.memory[static_cast<std::size_t>(i)]);
  }
  apply_compliance(field.equilibrium, 1.0, field.carried_n, field.equilibrium.sunk_m);
}

bool settle_contacts(CoupledField& field, const CoupledSet& set,
                     CoupledSurfaces surfaces) noexcept {
  for (Index i = 0; i < set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (field.at[self].slot >= 0) {
      field.equilibrium.depth_m(i) =
          set.sphere[self].radius_m - field.at[self].place.height_m - field.shift_m;
    }
  }
  Curves curves{&field, surfaces};
  return solve(field.equilibrium, {&curves, &evaluate_curves});
}

ContactReading read_contact(CoupledField& field, const CoupledSet& set,
                            CoupledSurfaces surfaces, int i) noexcept {
  ContactReading reading;
  const auto self = static_cast<std::size_t>(i);
  CoupledPlace& at = field.at[self];
  if (at.slot < 0) {
    return reading;
  }
  const CoupledContacts& c = field.equilibrium;
  const Real y = c.delta_m(i);
  const Real d = c.depth_m(i) + field.shift_m;
  const Real f = c.force_n(i);
  Vector3 slope = Vector3::Zero();  // dU by the place, d_i held [J]
  for (std::size_t a = 0; a < 3; ++a) {
    const auto row = static_cast<Index>(a);
    const Real weight = weight_of(at.place, a);
    if (!(at.lean[a] > 0.0)) {
      continue;
    }
    const NodeReading node = read_node(at, surfaces[i], a, y);
    reading.touching = reading.touching || (d > at.touch_m[a] && weight > 0.0);
    reading.loaded = reading.loaded || (node.past_m > 0.0 && weight > 0.0);
    reading.extrapolated =
        reading.extrapolated || (node.sample.extrapolated && weight > 0.0);
    slope += at.place.turn.row(row).transpose() * node.sample.energy_j;
  }
  RelaxingContact* remembered = has_memory(field, self) ? &field.memory[self] : nullptr;
  if (remembered != nullptr) {
    reading.loaded = is_touched(*remembered);
    slope = reading.loaded ? surface_slope_j(*remembered, surfaces[i].cache)
                           : Vector3::Zero();
  }
  const bool over_dent = remembered != nullptr && field.carried_n(i) > 0.0;
  if (!reading.loaded && !over_dent) {
    return reading;
  }
  if (at.place.folded) {
    reading.force_n = f * at.place.normal;
    return reading;
  }
  slope += coupling_slope_j(field, set, surfaces, self);
  reading.force_n = -gradient(at.place, slope, -f);
  return reading;
}

Real unloading_shift_m(const CoupledField& field, const CoupledSet& set) noexcept {
  Real most = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(set.count); ++i) {
    const CoupledPlace& at = field.at[i];
    for (std::size_t a = 0; a < 3 && at.slot >= 0; ++a) {
      if (at.lean[a] > 0.0) {
        most =
            std::max(most, set.sphere[i].radius_m - at.place.height_m - at.touch_m[a]);
      }
    }
  }
  return most;
}

}  // namespace palpate
