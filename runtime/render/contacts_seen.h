// What the fast thread shows of a tool of several contacts to who looks on: the latest
// tick, for a picture.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/contacts/coupled_step.h"
#include "runtime/realtime/triple_buffer.h"

namespace palpate {

/// A hand with its tool.
struct HandSeen {
  PortPose tool;    ///< of the tool ...
  PortPose device;  ///< ... and of the device, which a coupling keeps apart
  Wrench wrench;    ///< on the device's hand
};

struct ContactsSeen {
  std::array<HandSeen, kPortsMax> hand;
  std::int32_t count = 0;  ///< [0, kContactsMax]
  bool hung = false;       ///< there is a coupling
  bool scaled = false;     ///< C is not whole (coupled_contacts.h)
  std::array<CoupledContactPlace, kContactsMax> contact;
};

/// Written by the fast thread, read by one other.
using ContactsWatch = TripleBuffer<ContactsSeen>;

}  // namespace palpate
