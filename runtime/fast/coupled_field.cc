#include "runtime/fast/coupled_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate {
namespace {

using Index = Eigen::Index;

// Depth of a contact that has no element: of nothing.
constexpr Real kNowhereM = -1.0;

Real weight_of(const FieldPlace& place, std::size_t a) {
  return std::max(Real(0.0), place.frame.weight(static_cast<Index>(a)));
}

const Element& element_at(const CoupledSurface& surface, int slot) {
  return surface.cache.element[static_cast<std::size_t>(slot)];
}

// The place on the surface at rest.
Vector3 foot_m(const FieldPlace& place) {
  return place.prism.corner_m * place.frame.weight;
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

void force_at(CoupledPlace& at, const CoupledSurface& surface, Real y, Real& force,
              Real& stiffness) {
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

// The stored curves of all contacts at their delta.
void evaluate_curves(void* of, CoupledContacts& c, bool energy) {
  const auto& [field, surfaces] = *static_cast<Curves*>(of);
  for (Index i = 0; i < c.count; ++i) {
    CoupledPlace& at = field->at[static_cast<std::size_t>(i)];
    const Real y = at.slot >= 0 ? c.delta_m(i) : -std::numeric_limits<Real>::max();
    if (energy) {
      c.own_energy_j(i) = energy_at(at, surfaces[i], y);
    } else {
      force_at(at, surfaces[i], y, c.force_n(i), c.stiffness_n_per_m(i));
    }
  }
}

// The distance between contacts of two ports, among the knots, and the
// unit vector from the second to the first.
struct Apart {
  ComplianceWeights at;
  Vector3 toward = Vector3::Zero();
};

Apart apart(const CoupledField& field, const CoupledSet& set, std::size_t i,
            std::size_t j) {
  const Vector3 between = foot_m(field.at[i].place) - foot_m(field.at[j].place);
  const Real r = between.norm();
  return {compliance_weights(set.knots, static_cast<double>(r)),
          r > 0.0 ? Vector3(between / r) : Vector3::Zero()};
}

bool of_one_port(const CoupledSet& set, std::size_t i, std::size_t j) {
  return set.sphere[i].port == set.sphere[j].port;
}

// c_a of contact i's nodes at the contacts of other ports, which move.
void reach_other_ports(CoupledField& field, const CoupledSet& set,
                       CoupledSurfaces surfaces, std::size_t i) {
  CoupledPlace& at = field.at[i];
  const auto& row = surfaces[i].row[static_cast<std::size_t>(at.slot)];
  for (std::size_t j = 0; j < static_cast<std::size_t>(set.count); ++j) {
    if (of_one_port(set, i, j)) {
      continue;
    }
    const bool there = field.at[j].slot >= 0;
    const Apart pair = there ? apart(field, set, i, j) : Apart{};
    for (std::size_t a = 0; a < 3; ++a) {
      at.reach(static_cast<Index>(j), static_cast<Index>(a)) =
          there ? reach_m_per_n(row[a], pair.at) : Real(0.0);
    }
  }
}

// dc_i/dr at contact j of another port [1/N].
Real reach_slope(const CoupledField& field, const CoupledSet& set,
                 CoupledSurfaces surfaces, std::size_t i, std::size_t j) {
  const CoupledPlace& at = field.at[i];
  const auto& row = surfaces[i].row[static_cast<std::size_t>(at.slot)];
  const Apart pair = apart(field, set, i, j);
  Real slope = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    slope += weight_of(at.place, a) *
             static_cast<Real>(pair.at.of(row[a].value).slope_per_n);
  }
  return slope;
}

Real sign_of(const CoupledSet& set, int mode) {
  return mode < set.added_modes ? Real(1.0) : Real(-1.0);
}

// b of every contact at its place.
void read_modes(CoupledField& field, const CoupledSet& set) {
  for (Index i = 0; i < set.count && set.modes > 0; ++i) {
    const CoupledPlace& at = field.at[static_cast<std::size_t>(i)];
    for (int m = 0; m < set.modes; ++m) {
      Real b = 0.0;
      for (std::size_t a = 0; a < 3 && at.slot >= 0; ++a) {
        b += weight_of(at.place, a) * at.signed_mode(m, static_cast<Index>(a));
      }
      field.mode(i, m) = sign_of(set, m) * b;
    }
  }
}

// What modes add to C_ij.
Real coupling_by_modes(const CoupledField& field, const CoupledSet& set, Index i,
                       Index j) {
  Real sum = 0.0;
  for (int m = 0; m < set.modes; ++m) {
    sum += sign_of(set, m) * field.mode(i, m) * field.mode(j, m);
  }
  return sum;
}

// Displacement of contact i's nodes by the others' forces, as modes have it [m].
Vector3 sunk_by_modes_m(const CoupledField& field, const CoupledSet& set, Index i) {
  const auto f = field.equilibrium.force_n.head(set.count).matrix();
  Vector3 sunk = Vector3::Zero();
  for (int m = 0; m < set.modes; ++m) {
    const Real others = field.mode.col(m).head(set.count).dot(f) -
                        field.mode(i, m) * field.equilibrium.force_n(i);
    sunk +=
        others * field.at[static_cast<std::size_t>(i)].signed_mode.row(m).transpose();
  }
  return sunk;
}

// dU/dn_1 and dU/dn_2 by the change of distance to contacts of other ports.
Vector2 distance_slope_j(const CoupledField& field, const CoupledSet& set,
                         CoupledSurfaces surfaces, std::size_t i) {
  const CoupledContacts& c = field.equilibrium;
  Vector3 pull = Vector3::Zero();  // sum_j f_j dC_ij/dr, towards i
  for (std::size_t j = 0; j < static_cast<std::size_t>(set.count); ++j) {
    const Real f = c.force_n(static_cast<Index>(j));
    if (of_one_port(set, i, j) || f == 0.0) {
      continue;
    }
    const Real by_r = 0.5 * (reach_slope(field, set, surfaces, i, j) +
                             reach_slope(field, set, surfaces, j, i));
    pull += (f * by_r) * apart(field, set, i, j).toward;
  }
  const FieldPlace& place = field.at[i].place;
  return -(c.scale * c.force_n(static_cast<Index>(i))) *
         ((place.prism.corner_m * place.frame.turn).transpose() * pull);
}

}  // namespace

bool store(CoupledSurface& surface, const ContactElement& message) noexcept {
  const ElementMemory& memory = message.element.memory;
  if (memory.terms != 0 || memory.yields) {
    return false;
  }
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
  return true;
}

void enter(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
           int i) noexcept {
  const auto self = static_cast<std::size_t>(i);
  CoupledPlace& at = field.at[self];
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
    at.lean[a] = node.samples > 0 ? std::abs(n.dot(u)) : Real(0.0);
    at.touch_m[a] = node.touch_offset_m;
    for (int m = 0; m < set.modes; ++m) {
      const Real b = row[a].mode[static_cast<std::size_t>(m)];
      at.signed_mode(m, static_cast<Index>(a)) = m < set.added_modes ? b : -b;
    }
    for (std::size_t j = 0; j < static_cast<std::size_t>(set.count); ++j) {
      const bool couples = j != self && of_one_port(set, self, j);
      at.reach(static_cast<Index>(j), static_cast<Index>(a)) =
          couples ? reach_m_per_n(row[a], set.apart[self][j]) : Real(0.0);
    }
  }
}

void set_places(CoupledField& field, const CoupledSet& set,
                CoupledSurfaces surfaces) noexcept {
  CoupledContacts& c = field.equilibrium;
  const Index n = set.count;
  c.count = set.count;
  for (Index i = 0; i < n; ++i) {
    const auto self = static_cast<std::size_t>(i);
    CoupledPlace& at = field.at[self];
    auto column = c.compliance_m_per_n.col(i).head(n);
    if (at.slot < 0) {
      c.depth_m(i) = kNowhereM;
      column.setZero();
      continue;
    }
    c.depth_m(i) = set.sphere[self].radius_m - at.place.at.height_m - field.shift_m;
    if (set.ports > 1) {
      reach_other_ports(field, set, surfaces, self);
    }
    column = (0.5 * weight_of(at.place, 0)) * at.reach.col(0).head(n) +
             (0.5 * weight_of(at.place, 1)) * at.reach.col(1).head(n) +
             (0.5 * weight_of(at.place, 2)) * at.reach.col(2).head(n);
  }
  read_modes(field, set);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < j; ++i) {
      const Real both = c.compliance_m_per_n(i, j) + c.compliance_m_per_n(j, i) +
                        coupling_by_modes(field, set, i, j);
      c.compliance_m_per_n(i, j) = both;
      c.compliance_m_per_n(j, i) = both;
    }
  }
}

bool settle_contacts(CoupledField& field, const CoupledSet& set,
                     CoupledSurfaces surfaces) noexcept {
  for (Index i = 0; i < set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (field.at[self].slot >= 0) {
      field.equilibrium.depth_m(i) =
          set.sphere[self].radius_m - field.at[self].place.at.height_m - field.shift_m;
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
  Vector2 slope = Vector2::Zero();  // dU by n_1 and n_2 [J]
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
    slope += at.place.frame.turn.row(row).transpose() * node.sample.energy_j;
  }
  if (!reading.loaded) {
    return reading;
  }
  if (at.place.folded) {
    reading.force_n = f * at.place.frame.normal;
    return reading;
  }
  // A row is half of C_ij, a mode's product all of it.
  const Vector3 rows =
      at.reach.topRows(set.count).transpose() * c.force_n.head(set.count).matrix();
  const Vector3 sunk = 0.5 * rows + sunk_by_modes_m(field, set, i);
  slope -= at.place.frame.turn.transpose() * ((c.scale * f) * sunk);
  if (set.ports > 1) {
    slope += distance_slope_j(field, set, surfaces, self);
  }
  reading.force_n = -gradient(at.place.frame, slope(0), slope(1), -f);
  return reading;
}

Real unloading_shift_m(const CoupledField& field, const CoupledSet& set) noexcept {
  Real most = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(set.count); ++i) {
    const CoupledPlace& at = field.at[i];
    for (std::size_t a = 0; a < 3 && at.slot >= 0; ++a) {
      if (at.lean[a] > 0.0) {
        most = std::max(most,
                        set.sphere[i].radius_m - at.place.at.height_m - at.touch_m[a]);
      }
    }
  }
  return most;
}

}  // namespace palpate
