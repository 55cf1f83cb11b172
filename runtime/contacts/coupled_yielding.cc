#include "runtime/contacts/coupled_yielding.h"

#include <cstddef>

#include "runtime/memory/yield_step.h"

namespace palpate {
namespace {

constexpr int kRoundsMax = 4;

// @returns whether some contact's surface has yielded.
bool yield_all(const CoupledTick& t) {
  bool any = false;
  for (int i = 0; i < t.count(); ++i) {
    CoupledSurface& surface = t.surfaces[i];
    any = yield(t.model.field.memory[static_cast<std::size_t>(i)], surface.memory,
                surface.cache) ||
          any;
  }
  for (int i = 0; i < t.count() && any; ++i) {
    take_yielded(t.model.field.memory[static_cast<std::size_t>(i)],
                 t.surfaces[i].memory);
  }
  return any;
}

}  // namespace

void yield_here(const CoupledTick& t, PassivityLedger& ledger) noexcept {
  if (!t.model.field.remembers) {
    return;
  }
  bool any = false;
  for (int round = 0; round < kRoundsMax && yield_all(t); ++round) {
    any = true;
    (void)settle_contacts(t.model.field, t.set, t.surfaces);
  }
  if (!any) {
    return;
  }
  read_contacts(t);
  const double stored_j =
      static_cast<double>(t.model.field.equilibrium.energy_j + springs_j(t));
  if (stored_j <= ledger.stored_j) {  // more, of a scaled C, is for settle() to pay
    book_yielding(ledger, stored_j);
  }
}

}  // namespace palpate
