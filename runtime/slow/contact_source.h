// Interface to what answers the places of several contacts with surface elements. The
// interface is a seam, because a body may be shown as it is or as somebody wishes it to
// be.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "runtime/contacts/coupled_set.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/realtime/spsc_ring.h"
#include "runtime/slow/element_message.h"
#include "runtime/slow/tool_state.h"

namespace palpate {

/// One update of 64 contacts that all lie in other elements. About 6 MB.
constexpr std::size_t kContactFifoCapacity = 1024;
using ContactFifo = SpscRing<ContactElement, kContactFifoCapacity>;

/// What the fast process tells the slow one of all contacts.
struct ContactToolState {
  std::uint64_t sequence = 0;  ///< counts fast ticks from 1; 0: nothing written yet
  std::int32_t count = 0;
  std::array<ToolState, kContactsMax> contact;
};

/// What was last sent for each contact of a tool. An element is sent when a contact's
/// surroundings change. At every update one contact in turn, of more than 8 every
/// eighth, is sent again. So what was dropped comes back, and something always shows
/// that the slow process is there.
struct ContactSent {
  static constexpr int kRepeatUpdates = 8;  ///< at most, until each comes again
  struct Contact {
    WantedTriangles wanted;
    bool whole = false;  ///< nothing of it was dropped
  };
  std::array<Contact, kContactsMax> contact;
  std::uint64_t updates = 0;
};

/// One thread, the slow one.
class ContactSender {
 public:
  ContactSender() = default;
  virtual ~ContactSender() = default;
  ContactSender(const ContactSender&) = delete;
  ContactSender& operator=(const ContactSender&) = delete;

  /// The contacts that it sends for.
  [[nodiscard]] virtual const CoupledSet& set() const noexcept = 0;

  /// One slow step of all contacts. @returns messages pushed; what does not fit is
  /// dropped and counted by the ring, and sent again.
  virtual std::size_t update(const ContactToolState& tool, std::int64_t now_ns,
                             ContactFifo& fifo, ContactSent& sent) = 0;

  /// The present message for one triangle of contact i, without sequence and time.
  /// There is none where there is no such contact or triangle.
  [[nodiscard]] virtual std::optional<ContactElement> element_of(
      int i, std::int32_t triangle) const = 0;
};

}  // namespace palpate
