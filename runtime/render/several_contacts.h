// A tool that touches at several places at once, on a device that measures its place
// and pushes it, but does not turn it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "formats/response/response_table.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/render/rendered_body.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/coupled_storage.h"

namespace palpate {

/// Contacts coupled through the body (coupled_step.h), their axes along the body's.
/// The torque on the tool is not felt: it does no work where nothing turns.
class SeveralContacts : public RenderedBody {
 public:
  /// @param database outlives it. @param config model: kPotential. @param force_scale
  /// [-] (0, 1]. @throws InputError as coupled_set() and CoupledStorage.
  SeveralContacts(const ResponseDatabase& database, const ResponseTable& tool,
                  const FastConfig& config, double force_scale);

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
    return account_of(storage_.state()).work_j;
  }
  /// Of the first contact that touches.
  [[nodiscard]] std::int32_t triangle() const noexcept override;
  [[nodiscard]] std::uint64_t dropped() const noexcept override {
    return fifo_->dropped();
  }

  bool serve(std::int64_t now_ns) override;

  void begin_with(const std::vector<YieldedRow>& rows) override;

 private:
  [[nodiscard]] CoupledState& state() noexcept { return storage_.state(); }

  ContactStream stream_;
  CoupledStorage storage_;
  std::unique_ptr<ContactFifo> fifo_ = std::make_unique<ContactFifo>();
  std::unique_ptr<TripleBuffer<ContactToolState>> tool_ =
      std::make_unique<TripleBuffer<ContactToolState>>();
  ContactSent sent_;
  PortWrenches wrench_;  // of the latest step
};

}  // namespace palpate
