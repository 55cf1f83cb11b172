#include "runtime/contacts/coupled_compliance.h"

#include <algorithm>
#include <cstddef>

namespace palpate {
namespace {

using Index = Eigen::Index;

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

// What modes add to C.
void couple_by_modes(CoupledField& field, const CoupledSet& set) {
  const Index n = set.count;
  for (Index j = 0; j < n; ++j) {
    auto column = field.equilibrium.compliance_m_per_n.col(j).head(n);
    for (int m = 0; m < set.modes; ++m) {
      column += (sign_of(set, m) * field.mode(j, m)) * field.mode.col(m).head(n);
    }
    column(j) = 0.0;
  }
}

// C of the rows' halves, each in its contact's column.
void add_transposed(ContactMatrix& halves, Index n) {
  Real* const a = halves.data();
  for (Index j = 1; j < n; ++j) {
    Real* const column = a + j * kContactsMax;
    for (Index i = 0; i < j; ++i) {
      Real& other = a[i * kContactsMax + j];
      const Real both = column[i] + other;
      column[i] = both;
      other = both;
    }
  }
}

// Displacement of contact i's nodes by forces on the others [m]: by n_a what C_ij f_j
// changes by. A row is half of C_ij, a mode's product all of it.
Vector3 sunk_nodes_m(const CoupledField& field, const CoupledSet& set, Index i,
                     const ContactValues& force_n) {
  const auto f = force_n.head(set.count).matrix();
  const CoupledPlace& at = field.at[static_cast<std::size_t>(i)];
  const Vector3 rows = at.reach.topRows(set.count).transpose() * f;
  Vector3 modes = Vector3::Zero();
  for (int m = 0; m < set.modes; ++m) {
    const Real others =
        field.mode.col(m).head(set.count).dot(f) - field.mode(i, m) * force_n(i);
    modes += others * at.signed_mode.row(m).transpose();
  }
  return 0.5 * rows + modes;
}

// The same by the change of distance to contacts of other ports.
Vector3 sunk_by_distance_m(const CoupledField& field, const CoupledSet& set,
                           CoupledSurfaces surfaces, std::size_t i,
                           const ContactValues& force_n) {
  Vector3 pull = Vector3::Zero();  // sum_j f_j dC_ij/dr, towards i
  for (std::size_t j = 0; j < static_cast<std::size_t>(set.count); ++j) {
    const Real f = force_n(static_cast<Index>(j));
    if (of_one_port(set, i, j) || f == 0.0) {
      continue;
    }
    const Real by_r = 0.5 * (reach_slope(field, set, surfaces, i, j) +
                             reach_slope(field, set, surfaces, j, i));
    pull += (f * by_r) * apart(field, set, i, j).toward;
  }
  return foot_turn(field.at[i].place).transpose() * pull;
}

// What place i's rows say of C: halves of its column.
void read_rows(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
               std::size_t i) {
  CoupledPlace& at = field.at[i];
  const Index n = set.count;
  auto column = field.equilibrium.compliance_m_per_n.col(static_cast<Index>(i)).head(n);
  if (at.slot < 0) {
    column.setZero();
    return;
  }
  if (set.ports > 1) {
    reach_other_ports(field, set, surfaces, i);
  }
  column = (0.5 * weight_of(at.place, 0)) * at.reach.col(0).head(n) +
           (0.5 * weight_of(at.place, 1)) * at.reach.col(1).head(n) +
           (0.5 * weight_of(at.place, 2)) * at.reach.col(2).head(n);
}

}  // namespace

void couple_places(CoupledField& field, const CoupledSet& set,
                   CoupledSurfaces surfaces) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(set.count); ++i) {
    read_rows(field, set, surfaces, i);
  }
  read_modes(field, set);
  add_transposed(field.equilibrium.compliance_m_per_n, set.count);
  couple_by_modes(field, set);
}

Vector3 sunk_slope_m(const CoupledField& field, const CoupledSet& set,
                     CoupledSurfaces surfaces, std::size_t i,
                     const ContactValues& force_n) noexcept {
  Vector3 slope = field.at[i].place.turn.transpose() *
                  sunk_nodes_m(field, set, static_cast<Index>(i), force_n);
  if (set.ports > 1) {
    slope += sunk_by_distance_m(field, set, surfaces, i, force_n);
  }
  return field.equilibrium.scale * slope;
}

}  // namespace palpate
