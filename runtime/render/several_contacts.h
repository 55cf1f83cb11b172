// Tools that touch at several places at once, or two hands on one body. Their devices
// push them and may measure how they are turned.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/response/response_table.h"
#include "runtime/contacts/virtual_tool.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/render/contacts_seen.h"
#include "runtime/render/rendered_body.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/coupled_storage.h"

namespace palpate {

/// How tools of several contacts are held.
struct ContactsHeld {
  double force_scale = 1.0;  ///< [-] (0, 1]
  /// Holds each tool; none: its device does.
  std::optional<VirtualCoupling> coupling = {};
  /// Whether who turns the tools feels their torques: a simulated wrist does, no device
  /// does.
  bool torque_felt = false;
  /// Whether a turn that no wrist makes is a fault; a simulator's may jump.
  bool watch_turns = true;
  /// Sees every tick; null: nobody looks on. Outlives the body.
  ContactsWatch* watch = nullptr;
};

/// Contacts coupled through the body (coupled_step.h). Held by a device itself, a tool
/// is as the device measures it: its axes along the body's where turns are not
/// measured. Held by a virtual coupling (virtual_tool.h), it turns under its contacts.
/// A torque that is not felt does no work: turns that are measured are then a change of
/// the model (carry() of coupled_step.h).
class SeveralContacts : public RenderedBody {
 public:
  /// @param database outlives it. @param tools of it, one for each hand. @param config
  /// model: a field. @throws InputError as coupled_set(), CoupledStorage and couple().
  SeveralContacts(const ResponseDatabase& database,
                  std::span<const ResponseTable* const> tools, const FastConfig& config,
                  const ContactsHeld& held = {});
  /// @param stream that bodies share whose slow process is one; its scale of forces is
  /// what counts.
  SeveralContacts(std::shared_ptr<ContactSender> stream, const FastConfig& config,
                  const ContactsHeld& held = {});

  [[nodiscard]] std::size_t hands() const noexcept override {
    return static_cast<std::size_t>(storage_.state().set.ports);
  }
  [[nodiscard]] bool turns() const noexcept override { return true; }
  [[nodiscard]] bool torque_felt() const noexcept override { return torque_felt_; }
  void feel_torque(bool felt) noexcept override { torque_felt_ = felt; }

  bool take_in(ArrivalRecord& arrival) noexcept override;
  WrenchCommand step(const HandReadings& reading, double dt_s) noexcept override;
  void delivered(const PortWrenches& made) noexcept override;
  void raise(Fault fault) noexcept override { raise_fault(state(), fault); }
  void publish(const HandReadings& reading, std::int64_t ticks) noexcept override;

  /// The stream's body has changed. Every element that is held is taken from the stream
  /// anew, and a tick passes without time or movement. So the body changes for all
  /// contacts at once, and the ledger books that as a change. One contact of one hand
  /// gets its own at the next updates. Not in a tick, nor of a tool that hangs.
  void renew();

  /// For looking on and drawing; not in a tick.
  [[nodiscard]] CoupledState& state() noexcept { return storage_.state(); }
  [[nodiscard]] const CoupledState& state() const noexcept { return storage_.state(); }
  /// The coupling is not whole in the latest step (coupled_contacts.h).
  [[nodiscard]] bool scaled() const noexcept { return scaled_; }

  /// What has yielded stays.
  void restart() noexcept override;

  [[nodiscard]] FastContact contact() const noexcept override;
  [[nodiscard]] int contacts() const noexcept override {
    return storage_.state().set.count;
  }
  [[nodiscard]] BodyContact contact_at(int i) const noexcept override;
  [[nodiscard]] Fault fault() const noexcept override;
  [[nodiscard]] bool in_contact() const noexcept override {
    return storage_.state().in_contact;
  }
  [[nodiscard]] double work_j() const noexcept override {
    return virtual_tool_ != nullptr ? virtual_tool_->total.work_j
                                    : account_of(storage_.state()).work_j;
  }
  void account(const WrenchCommand& command,
               RenderReport& report) const noexcept override;
  /// Of the first contact that touches.
  [[nodiscard]] std::int32_t triangle() const noexcept override;
  [[nodiscard]] std::uint64_t dropped() const noexcept override {
    return fifo_->dropped();
  }

  [[nodiscard]] std::vector<SurfaceDent> dents() const override;

  void accept(const ArrivalRecord& arrival) override;
  std::optional<std::size_t> serve(std::int64_t now_ns) override;

  void begin_with(const KeptSurface& kept) override { begin_kept(kept, state()); }
  [[nodiscard]] KeptSurface kept() const override {
    return kept_surface(storage_.state());
  }

 private:
  void forget_what_is_under_way() noexcept;
  void show(const HandReadings& reading) noexcept;
  void watch_turns(const HandReadings& reading) noexcept;
  std::shared_ptr<ContactSender> stream_;
  CoupledStorage storage_;
  std::unique_ptr<VirtualTool> virtual_tool_;  // null: the device holds the tool
  std::unique_ptr<ContactFifo> fifo_ = std::make_unique<ContactFifo>();
  std::unique_ptr<TripleBuffer<ContactToolState>> tool_ =
      std::make_unique<TripleBuffer<ContactToolState>>();
  ContactSent sent_;                     // the slow thread's
  std::atomic<bool> forgotten_ = false;  // by the fast one: all is to be sent again
  HandReadings last_;                    // of the latest step
  bool stepped_ = false;
  PortWrenches wrench_;  // of the latest step
  bool scaled_ = false;  // likewise
  bool torque_felt_;
  bool watch_turns_;
  ContactsWatch* watch_;
  ContactsSeen seen_;
};

}  // namespace palpate
