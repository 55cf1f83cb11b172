// The fast process of a host's tool with several contacts, or of two hands on one body:
// what HostTool is to one contact.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/c_api/host_tool.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/coupled_storage.h"

namespace palpate {

/// What the two processes share.
struct ContactExchange {
  ContactFifo elements;                 ///< slow to fast
  TripleBuffer<ContactToolState> tool;  ///< fast to slow
  ContactSent sent;                     ///< the slow process's own
};

/// About 11 MB and 0.4 MB for each contact. Threads as of HostTool.
class HostContacts {
 public:
  /// @param set of several contacts. @param fast, tick_s, stall_s as of
  /// HostTool. @throws InputError.
  HostContacts(const CoupledSet& set, const FastConfig& fast, double tick_s,
               double stall_s);

  /// A sample without an orientation has the tool's frame along the body's.
  /// @param samples one for each of hands(); the first one's dt_s and torque_felt
  /// count.
  HostTick step(std::span<const HostSample> samples) noexcept;

  void delivered(const PortWrenches& made) noexcept {
    palpate::delivered(storage_.state(), made);
  }

  /// Forgets fault, account and place.
  void reset() noexcept;

  [[nodiscard]] int hands() const noexcept { return storage_.state().set.ports; }
  [[nodiscard]] ContactExchange& exchange() noexcept { return *exchange_; }

 private:
  CoupledStorage storage_;
  double tick_s_;
  double stall_s_;
  std::unique_ptr<ContactExchange> exchange_;
  double silent_s_ = 0.0;
  std::int64_t time_ns_ = 0;
  std::uint64_t sequence_ = 0;
  std::uint64_t ticks_ = 0;
};

}  // namespace palpate
