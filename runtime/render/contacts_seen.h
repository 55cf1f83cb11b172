// What the fast thread shows of a tool of several contacts to who looks on: the latest
// tick, for a picture.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/contacts/coupled_step.h"
#include "runtime/realtime/triple_buffer.h"

namespace palpate {

/// A place where tools of a body touch.
struct BodyContact {
  int hand = 0;
  double radius_m = 0.0;   ///< [m] of the sphere; else the tool's nominal height
  std::int32_t table = 0;  ///< of responses, as YieldedRow::table counts
  ContactPlace at;
};

/// A hand with its tool.
struct HandSeen {
  PortPose tool;    ///< of the tool ...
  PortPose device;  ///< ... and of the device, which a coupling keeps apart
  Wrench wrench;    ///< on the device's hand
};

struct ContactsSeen {
  std::array<HandSeen, kPortsMax> hand;
  std::int32_t count = 0;  ///< [0, kContactsMax]
  bool held = false;       ///< there is a coupling
  bool scaled = false;     ///< C is not whole (coupled_contacts.h)
  std::array<BodyContact, kContactsMax> contact;
};

/// Written by the fast thread, read by one other.
using ContactsWatch = TripleBuffer<ContactsSeen>;

}  // namespace palpate
