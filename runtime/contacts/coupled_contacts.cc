#include "runtime/contacts/coupled_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

// What is left of g [m].
constexpr Real kResidualM = rounding(1e-12, 2e-8);
// A step that leaves more than this of g asks for another factor ...
constexpr Real kSlow = 0.1;
// ... and any, where so few contacts have a slope: it costs less than an evaluation
// more.
constexpr int kFactoredAtOnce = 40;
// A Newton step is halved at most so often.
constexpr int kHalvingsMax = 6;
// C is halved at most so often before it is left out.
constexpr int kScalesMax = 8;
// Least pivot of S that still counts as positive: against those of rounding.
constexpr Real kPivotMin = rounding(1e-9, 1e-4);

using Index = Eigen::Index;

// L of the matrix in its place, column by column, four columns of the past at a time.
bool factor_in_place(ContactMatrix& a, ContactValues& inverse, Index n) {
  // a_ij -= sum_{k < j} L_ik L_jk for i >= j; then L_ij = a_ij / sqrt(a_jj). The
  // factor's entry c_k[j] is L_jk.
  for (Index j = 0; j < n; ++j) {
    Real* column = a.col(j).data();
    Index k = 0;
    for (; k + 4 <= j; k += 4) {
      const Real* c0 = a.col(k).data();
      const Real* c1 = a.col(k + 1).data();
      const Real* c2 = a.col(k + 2).data();
      const Real* c3 = a.col(k + 3).data();
      const Real w0 = c0[j];
      const Real w1 = c1[j];
      const Real w2 = c2[j];
      const Real w3 = c3[j];
      for (Index i = j; i < n; ++i) {
        column[i] -= (w0 * c0[i] + w1 * c1[i]) + (w2 * c2[i] + w3 * c3[i]);
      }
    }
    for (; k < j; ++k) {
      const Real* past = a.col(k).data();
      const Real w = past[j];
      for (Index i = j; i < n; ++i) {
        column[i] -= w * past[i];
      }
    }
    // S has ones on its diagonal, so that a pivot is relative to one. NaN fails, too.
    if (!(column[j] > kPivotMin)) {
      return false;
    }
    const Real inverse_root = Real(1.0) / std::sqrt(column[j]);
    inverse(j) = inverse_root;
    for (Index i = j; i < n; ++i) {
      column[i] *= inverse_root;
    }
  }
  return true;
}

// S^-1 b in the place of b.
void solve_factored(const CoupledFactor& factor, ContactValues& b) {
  const Index n = factor.count;
  for (Index j = 0; j < n; ++j) {
    const Real* column = factor.lower.col(j).data();
    const Real x = b(j) * factor.inverse(j);
    b(j) = x;
    for (Index i = j + 1; i < n; ++i) {
      b(i) -= column[i] * x;
    }
  }
  for (Index j = n - 1; j >= 0; --j) {
    const auto rest = n - j - 1;
    const Real past =
        factor.lower.col(j).segment(j + 1, rest).dot(b.segment(j + 1, rest).matrix());
    b(j) = (b(j) - past) * factor.inverse(j);
  }
}

// S of the contacts with a slope. False where it is not positive definite.
bool make_factor(const CoupledContacts& c, Real scale, CoupledFactor& factor) {
  Index n = 0;
  for (Index i = 0; i < c.count; ++i) {
    const Real k = c.stiffness_n_per_m(i);
    if (k > 0.0 && std::isfinite(k)) {
      factor.contact[static_cast<std::size_t>(n)] = static_cast<std::int8_t>(i);
      factor.root(n++) = std::sqrt(k);
    }
  }
  factor.count = static_cast<int>(n);
  for (Index q = 0; q < n; ++q) {
    const Real* compliance =
        c.compliance_m_per_n.col(factor.contact[static_cast<std::size_t>(q)]).data();
    Real* column = factor.lower.col(q).data();
    const Real w = scale * factor.root(q);
    column[q] = 1.0;
    for (Index p = q + 1; p < n; ++p) {
      column[p] =
          w * factor.root(p) * compliance[factor.contact[static_cast<std::size_t>(p)]];
    }
  }
  factor.sound = factor_in_place(factor.lower, factor.inverse, n);
  return factor.sound;
}

// A factor to step by: of a smaller C where the whole one is not positive definite
// there. @returns whether it is the whole one's.
bool renew_factor(CoupledContacts& c) {
  Real scale = c.scale;
  ++c.factorings;
  const bool whole = make_factor(c, scale, c.factor);
  for (int i = 0; !c.factor.sound && i < kScalesMax; ++i) {
    scale *= 0.5;
    ++c.factorings;
    (void)make_factor(c, i + 1 == kScalesMax ? Real(0.0) : scale, c.factor);
  }
  return whole;
}

// d - C s.
auto asked_m(const CoupledContacts& c) {
  return c.depth_m.head(c.count) - c.scale * c.sunk_m.head(c.count);
}

// Curves and dimples at delta. @returns the largest |g|.
Real evaluate(CoupledContacts& c, const ContactCurves& curves, ContactValues& g) {
  ++c.evaluations;
  curves.evaluate(curves.of, c, false);
  apply_compliance(c, c.scale, c.force_n, c.dimple_m);
  const Index n = c.count;
  g.head(n) = c.delta_m.head(n) + c.dimple_m.head(n) - asked_m(c);
  return g.head(n).abs().maxCoeff<Eigen::PropagateNaN>();
}

// The change of delta by the factor.
void find_change(const CoupledContacts& c, const ContactValues& g,
                 ContactValues& change) {
  const CoupledFactor& factor = c.factor;
  ContactValues reduced;
  for (Index q = 0; q < factor.count; ++q) {
    reduced(q) = -factor.root(q) * g(factor.contact[static_cast<std::size_t>(q)]);
  }
  solve_factored(factor, reduced);
  ContactValues y = ContactValues::Zero();
  for (Index q = 0; q < factor.count; ++q) {
    y(factor.contact[static_cast<std::size_t>(q)]) = factor.root(q) * reduced(q);
  }
  apply_compliance(c, c.scale, y, change);
  change.head(c.count) = -g.head(c.count) - change.head(c.count);
}

bool is_convex(CoupledContacts& c) {
  ++c.factorings;
  return make_factor(c, c.scale, c.factor);
}

// Newton's method from delta. @returns whether it ended at a solution that is unique
// around it.
bool iterate(CoupledContacts& c, const ContactCurves& curves) {
  const Index n = c.count;
  ContactValues g;
  ContactValues change;
  Real left = evaluate(c, curves, g);
  bool fresh = false;  // the factor is that of this delta
  bool whole = true;   // no factor was refused
  const int evaluations_max = c.evaluations + kCoupledEvaluationsMax;
  while (!(left <= kResidualM)) {
    if (!std::isfinite(left) || c.evaluations >= evaluations_max) {
      return false;
    }
    if (!c.factor.sound) {
      whole = renew_factor(c) && whole;
      fresh = true;
    }
    find_change(c, g, change);
    const ContactValues from = c.delta_m;
    const Real before = left;
    Real step = 1.0;
    c.delta_m.head(n) = from.head(n) + change.head(n);
    left = evaluate(c, curves, g);
    for (int i = 0; fresh && i < kHalvingsMax && !(left < before); ++i) {
      step *= 0.5;
      c.delta_m.head(n) = from.head(n) + step * change.head(n);
      left = evaluate(c, curves, g);
    }
    bool old = c.factor.count > kFactoredAtOnce && left < kSlow * before;
    if (!fresh && !(left < before)) {  // an old factor: again from here with a new one
      c.delta_m = from;
      left = evaluate(c, curves, g);
      old = false;
    }
    c.factor.sound = old || left <= kResidualM;
    fresh = false;
  }
  return whole || is_convex(c);
}

// From the last solution to first order in the change of depths: there g is that
// change's negative.
void begin_at_last(CoupledContacts& c) {
  const Index n = c.count;
  if (c.solved == c.count && c.factor.sound) {
    ContactValues g;
    g.head(n) = c.solved_depth_m.head(n) - asked_m(c);
    ContactValues change;
    find_change(c, g, change);
    c.delta_m.head(n) += change.head(n);
  } else {
    c.delta_m.head(n) = asked_m(c) - c.dimple_m.head(n);
  }
  if (!c.delta_m.head(n).allFinite()) {
    c.delta_m.head(n) = c.depth_m.head(n);
  }
}

void sum_energy(CoupledContacts& c) {
  const Index n = c.count;
  c.solved = c.count;
  c.solved_depth_m.head(n) = asked_m(c);
  // U = sum [E_i + f_i (d_i - delta_i - (C f)_i / 2)], with g = 0 the sum of E_i and of
  // f.C f / 2. This form is stationary in f: what is left of g counts by its square.
  c.energy_j = (c.own_energy_j.head(n) +
                c.force_n.head(n) * (c.solved_depth_m.head(n) - c.delta_m.head(n) -
                                     0.5 * c.dimple_m.head(n)))
                   .sum();
}

}  // namespace

void apply_compliance(const CoupledContacts& contacts, Real factor,
                      const ContactValues& v, ContactValues& out) noexcept {
  const Index n = contacts.count;
  out.head(n).setZero();
  for (Index j = 0; j < n; ++j) {
    if (v(j) != 0.0) {
      out.head(n) +=
          (factor * v(j)) * contacts.compliance_m_per_n.col(j).head(n).array();
    }
  }
}

bool solve(CoupledContacts& contacts, const ContactCurves& curves) noexcept {
  CoupledContacts& c = contacts;
  const Index n = c.count;
  c.evaluations = 0;
  c.factorings = 0;
  c.energy_j = 0.0;
  if (n == 0) {
    return true;
  }
  const Real asked = c.scale;
  begin_at_last(c);
  bool found = iterate(c, curves);
  for (int i = 0; !found; ++i) {
    c.factor.sound = false;
    c.delta_m.head(n) = c.depth_m.head(n);
    if (i == kScalesMax || !c.depth_m.head(n).allFinite()) {
      c.scale = c.depth_m.head(n).allFinite() ? Real(0.0) : asked;
      curves.evaluate(curves.of, c, false);
      c.dimple_m.head(n).setZero();
      found = true;
    } else {
      found = iterate(c, curves);  // from the uncoupled depths
      if (!found) {
        c.scale *= 0.5;
      }
    }
  }
  curves.evaluate(curves.of, c, true);
  sum_energy(c);
  return c.scale == asked;
}

Real coupled_stiffness_n_per_m(const CoupledContacts& contacts, int i,
                               CoupledFactor& scratch) noexcept {
  const Real k = contacts.stiffness_n_per_m(i);
  if (!make_factor(contacts, contacts.scale, scratch) || !(k > 0.0)) {
    return k;
  }
  // K (1 + C K)^-1 = D S^-1 D.
  ContactValues unit = ContactValues::Zero();
  Index row = 0;
  while (scratch.contact[static_cast<std::size_t>(row)] != i) {
    ++row;
  }
  unit(row) = scratch.root(row);
  solve_factored(scratch, unit);
  return scratch.root(row) * unit(row);
}

}  // namespace palpate
