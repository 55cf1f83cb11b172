#include "runtime/contacts/coupled_relaxation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "runtime/memory/relaxation_step.h"

namespace palpate {
namespace {

// This share of u is rounding, besides kShortJ.
constexpr Real kEnergyRounding = rounding(1e-14, 1e-6);

using Index = Eigen::Index;

bool remembers(const CoupledTick& t, int i) {
  return t.model.field.memory[array_index(i)].remembers;
}

// Calls f(contact, its memory in a step) for every bundle that something is
// remembered of.
template <typename Function>
void for_each_bundle(const CoupledTick& t, const Function& f) {
  for (int i = 0; i < t.count(); ++i) {
    if (remembers(t, i)) {
      const int bundles = t.model.field.memory[array_index(i)].nodes.bundles;
      for (int b = 0; b < bundles; ++b) {
        f(i, b);
      }
    }
  }
}

RelaxingContact& memory_of(const CoupledTick& t, int i) {
  return t.model.field.memory[array_index(i)];
}

BundleInStep& in_step(const CoupledTick& t, int i, int bundle) {
  return t.model.relaxing.bundle[array_index(i)][array_index(bundle)];
}

// Where all bundles begin.
void begin_step(const CoupledTick& t) {
  for_each_bundle(t, [&](int i, int b) {
    RelaxingContact& contact = memory_of(t, i);
    BundleInStep& step = in_step(t, i, b);
    step.start = start_of(contact, b);
    step.idle = !step.start.pressed && !contact.bundle[array_index(b)].is_marked();
    if (!step.start.pressed && !step.idle) {
      const auto& forces = contact.sites.relaxed_n[array_index(b)];
      std::copy_n(forces.begin(), contact.sites.count, step.site_n.begin());
    }
  });
}

// Lets one bundle go on for time_s from where the step began.
void advance_bundle(const CoupledTick& t, int i, int b, Real time_s) {
  RelaxingContact& contact = memory_of(t, i);
  const SurfaceMemory& memory = t.surfaces[i].memory;
  BundleInStep& step = in_step(t, i, b);
  if (step.idle) {
    return;
  }
  step.share = passed_shares(memory, time_s);
  if (!step.start.pressed) {
    std::copy_n(step.site_n.begin(), contact.sites.count,
                contact.sites.relaxed_n[array_index(b)].begin());
    if (recover(contact, memory, b, time_s)) {
      return;
    }
    step.start.pressed = true;
  }
  press(contact, step.start, step.share, b);
}

// The equilibrium after a step of all contacts. @returns its energy.
Real energy_after_j(const CoupledTick& t, Real time_s) {
  CoupledField& field = t.model.field;
  for_each_bundle(t, [&](int i, int b) {
    advance_bundle(t, i, b, time_s);
  });
  take_relaxed(field, t.set);
  (void)settle_contacts(field, t.set, t.surfaces);
  return field.equilibrium.energy_j;
}

// The step for as much of its time as raises u by no more than paid_j.
// @returns by how much.
double shortened_j(const CoupledTick& t, Real time_s, double before_j, double paid_j) {
  const auto risen_j = [&](Real part) {
    return static_cast<double>(energy_after_j(t, part * time_s)) - before_j;
  };
  Real low = 0.0;
  Real high = 1.0;
  for (int i = 0; i < kShortenMax; ++i) {
    const Real middle = Real(0.5) * (low + high);
    (risen_j(middle) <= paid_j ? low : high) = middle;
  }
  return risen_j(low);
}

// A step of all contacts that the account can pay. @returns by how much u rises.
double step_j(const CoupledTick& t, const PassivityLedger& ledger, Real time_s) {
  const double before_j = static_cast<double>(t.model.field.equilibrium.energy_j);
  const double risen_j = static_cast<double>(energy_after_j(t, time_s)) - before_j;
  const double short_j = risen_j - ledger.dent_j;
  if (!(short_j > 0.0)) {
    return risen_j;
  }
  if (short_j <= kShortJ + static_cast<double>(kEnergyRounding) * before_j) {
    return static_cast<double>(energy_after_j(t, 0.0)) - before_j;
  }
  ++t.model.relaxing.shortened;
  t.model.relaxing.shortened_j += short_j;
  return shortened_j(t, time_s, before_j, ledger.dent_j);
}

// What the coupling makes more of the contacts' loss and of their V: sums over terms of
// g_k (1 - share_k) went_k . C (p_0 - q_k), and 1/2 [sum g_k q_k . C q_k - s . C s].
struct CouplingPart {
  TermValues lost_j = TermValues::Zero();
  Real stored_j = 0.0;
};

// q_k, how far it went and p_0 of contact i, of all bundles together.
struct TermForces {
  Real now_n = 0.0;
  Real went_n = 0.0;
  Real missing_n = 0.0;
};

TermForces term_forces(const CoupledTick& t, int i, Index k) {
  TermForces sum;
  const RelaxingContact& contact = memory_of(t, i);
  for (int b = 0; b < contact.nodes.bundles; ++b) {
    const BundleStart& start = in_step(t, i, b).start;
    const Real now = contact.bundle[array_index(b)].memory.relaxed_n.value(k);
    sum.now_n += now;
    sum.went_n += now - start.relaxed_n(k);
    sum.missing_n += start.target_n - now;
  }
  return sum;
}

// Of one term, with the roots of g_k at both places as g_k.
void add_term(const CoupledTick& t, Index k, CouplingPart& part) {
  const CoupledContacts& c = t.model.field.equilibrium;
  const Index n = t.count();
  ContactValues now = ContactValues::Zero();
  ContactValues went = ContactValues::Zero();
  ContactValues missing = ContactValues::Zero();
  for (int i = 0; i < n; ++i) {
    if (remembers(t, i)) {
      const Real root = std::sqrt(memory_of(t, i).sites.place_relaxing.value(k));
      const TermForces forces = term_forces(t, i, k);
      now(i) = root * forces.now_n;
      went(i) = root * forces.went_n;
      missing(i) = root * forces.missing_n;
    }
  }
  ContactValues sunk;
  apply_compliance(c, c.scale, now, sunk);
  part.stored_j += Real(0.5) * now.head(n).matrix().dot(sunk.head(n).matrix());
  apply_compliance(c, c.scale, missing, sunk);
  part.lost_j(k) += went.head(n).matrix().dot(sunk.head(n).matrix());
}

Index terms_of(const CoupledTick& t) {
  Index terms = 0;
  for (int i = 0; i < t.count(); ++i) {
    if (remembers(t, i)) {
      terms = std::max(terms, t.surfaces[i].memory.times.terms);
    }
  }
  return terms;
}

CouplingPart coupling_part(const CoupledTick& t) {
  const CoupledField& field = t.model.field;
  const Index n = t.count();
  CouplingPart part;
  const Index terms = terms_of(t);
  for (Index k = 0; k < terms; ++k) {
    add_term(t, k, part);
  }
  part.stored_j -=
      Real(0.5) * field.equilibrium.scale *
      field.carried_n.head(n).matrix().dot(field.equilibrium.sunk_m.head(n).matrix());
  return part;
}

// Writes the step to the sites. @returns what it lost of u + V, to first order and not
// more.
double write_contacts(const CoupledTick& t, const CouplingPart& coupling) {
  TermValues above = coupling.lost_j;
  TermValues stays = TermValues::Ones();
  for_each_bundle(t, [&](int i, int b) {
    RelaxingContact& contact = memory_of(t, i);
    const BundleInStep& step = in_step(t, i, b);
    if (step.idle) {
      return;
    }
    above += contact.sites.place_relaxing.value * way_down(contact, step.start, b);
    stays = stays.min(Real(1.0) - step.share);
    write_step(contact, step.start, step.share, b);
  });
  return static_cast<double>((stays * above.max(Real(0.0))).sum());
}

// Books what the dents at hand store.
void settle_dents(const CoupledTick& t, PassivityLedger& ledger, Real coupling_j) {
  double holds_j = static_cast<double>(coupling_j);
  for_each_bundle(t, [&](int i, int b) {
    RelaxingContact& contact = memory_of(t, i);
    contact.steps += b == 0 ? 1 : 0;
    if (contact.bundle[array_index(b)].is_marked()) {
      holds_j += dent_j(contact, t.surfaces[i].memory, t.surfaces[i].cache, b);
    }
  });
  book_dent(ledger, holds_j);
}

// As in relaxation_step.cc, at the slowest of all contacts.
void recover_left_at_slowest(const CoupledTick& t, PassivityLedger& ledger,
                             Real time_s) {
  if (!(ledger.left_j > 0.0)) {
    return;
  }
  Real slowest_hz = 0.0;
  bool any = false;
  for (int i = 0; i < t.count(); ++i) {
    const RelaxationTimes& times = t.surfaces[i].memory.times;
    if (times.terms == 0) {
      continue;
    }
    const Real stays = std::max(
        Real(0.0), Real(1.0) - memory_of(t, i).sites.place_relaxing.value.sum());
    const Real hz = stays * times.rate_hz(times.terms - 1);
    slowest_hz = any ? std::min(slowest_hz, hz) : hz;
    any = true;
  }
  const Real x = time_s * slowest_hz;
  book_recovery(ledger, static_cast<double>(x / (Real(1.0) + x)));
}

// Time that has gathered, if it is enough for the shortest tau_k of all contacts.
Real pass_time(const CoupledTick& t, Real half_s) {
  Real rate_hz = 0.0;
  for (int i = 0; i < t.count(); ++i) {
    rate_hz = std::max(rate_hz, t.surfaces[i].memory.times.rate_hz(0));
  }
  Real& gathered_s = t.model.relaxing.gathered_s;
  gathered_s = rate_hz > 0.0 ? gathered_s + half_s : Real(0.0);
  if (!(gathered_s * rate_hz >= kGathered)) {
    return 0.0;
  }
  return std::exchange(gathered_s, Real(0.0));
}

void let_time_pass(const CoupledTick& t, Real time_s) {
  for (int i = 0; i < t.count(); ++i) {
    SurfaceMemory& memory = t.surfaces[i].memory;
    memory.time_s += static_cast<double>(time_s);
    if (remembers(t, i)) {
      memory_of(t, i).sites.time_s = memory.time_s;
    }
  }
}

// One step of all contacts, booked.
void relax(const CoupledTick& t, PassivityLedger& ledger, Real time_s) {
  const Real scale = t.model.field.equilibrium.scale;
  begin_step(t);
  if (!(ledger.dent_j > 0.0) && ledger.left_j > 0.0) {  // come back to
    settle_dents(t, ledger, coupling_part(t).stored_j);
  }
  double risen_j = step_j(t, ledger, time_s);
  const bool same = t.model.field.equilibrium.scale == scale;
  if (!same) {  // another energy: no step, and a change of the model for the account
    (void)energy_after_j(t, 0.0);
    risen_j = 0.0;
  }
  const CouplingPart coupling = coupling_part(t);
  book_relaxing(ledger, risen_j, write_contacts(t, coupling));
  settle_dents(t, ledger, coupling.stored_j);
  read_contacts(t);
  if (!same) {
    settle(t, ledger, 0.0);
  }
}

}  // namespace

void relax_here(const CoupledTick& t, PassivityLedger& ledger, Real half_s) noexcept {
  const Real time_s = pass_time(t, half_s);
  if (!(time_s > 0.0)) {
    return;
  }
  let_time_pass(t, time_s);
  if (t.model.field.remembers) {
    relax(t, ledger, time_s);
  } else {
    book_dent(ledger, 0.0);
  }
  recover_left_at_slowest(t, ledger, time_s);
}

}  // namespace palpate
