#include "runtime/view/adjusted_contacts.h"

#include <cmath>
#include <cstddef>

#include "runtime/view/adjusted_elements.h"

namespace palpate {

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

std::optional<ContactElement> AdjustedContacts::element_of(
    int i, std::int32_t triangle) const {
  std::optional<ContactElement> message = stream_.element_of(i, triangle);
  if (message) {
    adjust(*message, coupled_);
  }
  return message;
}

std::size_t AdjustedContacts::update(const ContactToolState& tool, std::int64_t now_ns,
                                     ContactFifo& fifo, ContactSent& sent) {
  (void)stream_.update(tool, now_ns, *unchanged_, sent);
  std::size_t pushed = 0;
  while (const ContactElement* front = unchanged_->front()) {
    ContactElement message = *front;
    unchanged_->pop();
    adjust(message, coupled_);
    pushed += fifo.push(message) ? 1 : 0;
  }
  return pushed;
}

}  // namespace palpate
