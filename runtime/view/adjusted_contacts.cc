#include "runtime/view/adjusted_contacts.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "runtime/view/adjusted_elements.h"

namespace palpate {
namespace {

struct Held {
  std::int32_t triangle;
  std::uint64_t sequence;
  std::int64_t sent_ns;
  bool active;
};

// The elements of one contact, that which is in use first.
std::vector<Held> held_in(const ElementCache& cache) {
  std::vector<Held> held;
  for (int slot = 0; slot < kCacheSlots; ++slot) {
    const auto s = static_cast<std::size_t>(slot);
    if (cache.stored_at[s] == 0 || find(cache, cache.triangle[s]) != slot) {
      continue;
    }
    const Element& element = cache.element[s];
    const Held one{cache.triangle[s], element.sequence, element.sent_ns,
                   slot == cache.newest_active};
    held.insert(slot == cache.pinned ? held.begin() : held.end(), one);
  }
  return held;
}

}  // namespace

void AdjustedContacts::adjust(ContactElement& message, bool coupled) const {
  for (ElementNode& node : message.element.node) {
    adjust_node(node, scale_, friction_);
  }
  // n bodies side by side are n times as stiff, and sink by an n-th.
  const auto softer = coupled ? static_cast<float>(1.0 / scale_) : 0.0F;
  const auto root = coupled ? static_cast<float>(1.0 / std::sqrt(scale_)) : 0.0F;
  for (ContactRow& row : message.row) {
    for (float& value : row.value) {
      value *= softer;
    }
    for (float& value : row.mode) {
      value *= root;
    }
  }
}

ContactElement AdjustedContacts::element(int i, std::int32_t triangle,
                                         bool coupled) const {
  ContactElement message = stream_.element(i, triangle);
  adjust(message, coupled);
  return message;
}

std::size_t AdjustedContacts::update(const ContactToolState& tool, std::int64_t now_ns,
                                     ContactFifo& fifo) {
  (void)stream_.update(tool, now_ns, *unchanged_, sent_);
  std::size_t pushed = 0;
  while (const ContactElement* front = unchanged_->front()) {
    ContactElement message = *front;
    unchanged_->pop();
    adjust(message, coupled_);
    pushed += fifo.push(message) ? 1 : 0;
  }
  return pushed;
}

void AdjustedContacts::renew(CoupledState& state) {
  forget();
  if (is_alone(state.set)) {
    return;
  }
  for (int i = 0; i < state.set.count; ++i) {
    for (const Held& held : held_in(state.surfaces[i].cache)) {
      if (find(state.surfaces[i].cache, held.triangle) < 0) {
        continue;  // gave way to the copy of the one in use
      }
      ContactElement message = element(i, held.triangle, coupled_);
      message.element.sequence = held.sequence;
      message.element.sent_ns = held.sent_ns;
      message.element.active = held.active;
      accept(state, message);
    }
  }
  if (state.sampled) {
    (void)step(state, state.latest, 0.0);
  }
}

}  // namespace palpate
