// A tool that touches at several places at once, on a device that pushes it and may
// measure how it is turned, but does not turn it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "formats/response/response_table.h"
#include "runtime/contacts/hung_tool.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/render/contacts_seen.h"
#include "runtime/render/rendered_body.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/coupled_storage.h"

namespace palpate {

/// Contacts coupled through the body (coupled_step.h). Held by the device itself, the
/// tool is as the device measures it: its axes along the body's where turns are not
/// measured. Held by a virtual coupling (hung_tool.h), it turns under its contacts. The
/// torque on the device is not felt: it does no work where nothing turns, and turns
/// that are measured are a change of the model (carry() of coupled_step.h); one that no
/// wrist makes is the fault "jump".
class SeveralContacts : public RenderedBody {
 public:
  /// @param database outlives it. @param config model: kPotential. @param force_scale
  /// [-] (0, 1]. @param coupling that holds the tool; none: the device does. @throws
  /// InputError as coupled_set(), CoupledStorage and hang(). @param watch sees every
  /// tick; null: nobody looks on; else it outlives this.
  SeveralContacts(const ResponseDatabase& database, const ResponseTable& tool,
                  const FastConfig& config, double force_scale,
                  const std::optional<VirtualCoupling>& coupling = {},
                  ContactsWatch* watch = nullptr);

  bool take_in(ArrivalRecord& arrival) noexcept override;
  FastCommand step(const DeviceReading& reading, double dt_s) noexcept override;
  void delivered(const Eigen::Vector3d& force_n) noexcept override;
  void raise(Fault fault) noexcept override { raise_fault(state(), fault); }
  void publish(const DeviceReading& reading, std::int64_t ticks) noexcept override;

  [[nodiscard]] Fault fault() const noexcept override;
  [[nodiscard]] bool in_contact() const noexcept override {
    return storage_.state().in_contact;
  }
  [[nodiscard]] double work_j() const noexcept override {
    return hung_ != nullptr ? hung_->total.work_j : account_of(storage_.state()).work_j;
  }
  void account(const FastCommand& command,
               RenderReport& report) const noexcept override;
  /// Of the first contact that touches.
  [[nodiscard]] std::int32_t triangle() const noexcept override;
  [[nodiscard]] std::uint64_t dropped() const noexcept override {
    return fifo_->dropped();
  }

  [[nodiscard]] std::vector<SurfaceDent> dents() const override;

  bool serve(std::int64_t now_ns) override;

  void begin_with(const std::vector<YieldedRow>& rows) override;

 private:
  void show(const DeviceReading& reading) noexcept;
  void watch_turn(const DeviceReading& reading) noexcept;
  [[nodiscard]] CoupledState& state() noexcept { return storage_.state(); }

  ContactStream stream_;
  CoupledStorage storage_;
  std::unique_ptr<HungTool> hung_;  // null: the device holds the tool
  std::unique_ptr<ContactFifo> fifo_ = std::make_unique<ContactFifo>();
  std::unique_ptr<TripleBuffer<ContactToolState>> tool_ =
      std::make_unique<TripleBuffer<ContactToolState>>();
  ContactSent sent_;
  DeviceReading last_;  // of the latest step
  bool stepped_ = false;
  PortWrenches wrench_;  // of the latest step
  bool scaled_ = false;  // likewise
  ContactsWatch* watch_;
  ContactsSeen seen_;
};

}  // namespace palpate
