// A tool that touches at one place, as the two processes render it.
#pragma once

#include <memory>
#include <vector>

#include "runtime/fast/fast_step.h"
#include "runtime/fast/switch_model.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/render/friction_seen.h"
#include "runtime/render/needle_seen.h"
#include "runtime/render/rendered_body.h"
#include "runtime/slow/element_source.h"
#include "runtime/slow/tool_state.h"

namespace palpate {

/// What the two processes share.
struct RenderExchange {
  ElementFifo elements;          ///< slow to fast
  TripleBuffer<ToolState> tool;  ///< fast to slow
};

/// About 80 kB: lives on the heap.
class OneContact : public RenderedBody {
 public:
  /// The stream must outlive it. @throws InputError if the configuration is not valid.
  /// @param watch sees a needle in every tick, `rubbed` the friction; null: nobody
  /// looks on. They outlive this.
  OneContact(const FastConfig& config, ElementSender& stream,
             NeedleWatch* watch = nullptr, FrictionWatch* rubbed = nullptr);

  bool take_in(ArrivalRecord& arrival) noexcept override;
  WrenchCommand step(const HandReadings& reading, double dt_s) noexcept override;
  void delivered(const PortWrenches& made) noexcept override {
    palpate::delivered(state_, made[0].force_n);
  }
  void raise(Fault fault) noexcept override { raise_fault(state_, fault); }
  void publish(const HandReadings& reading, std::int64_t ticks) noexcept override;

  /// What has yielded stays.
  void restart() noexcept override;

  [[nodiscard]] FastContact contact() const noexcept override {
    return palpate::contact(state_);
  }
  [[nodiscard]] BodyContact contact_at(int /*i*/) const noexcept override {
    return {.radius_m = state_.config.tool_radius_m, .at = contact_place(state_)};
  }
  [[nodiscard]] NeedleSeen needle() const noexcept override {
    return needle_seen(state_);
  }
  [[nodiscard]] FrictionSeen friction() const noexcept override {
    return friction_seen(state_);
  }
  [[nodiscard]] Fault fault() const noexcept override { return state_.safety.fault; }
  [[nodiscard]] bool in_contact() const noexcept override { return state_.in_contact; }
  [[nodiscard]] double work_j() const noexcept override { return state_.ledger.work_j; }
  [[nodiscard]] std::int32_t triangle() const noexcept override {
    return active_triangle(state_);
  }
  [[nodiscard]] std::uint64_t dropped() const noexcept override {
    return exchange_->elements.dropped();
  }
  void account(const WrenchCommand& command,
               RenderReport& report) const noexcept override;

  void accept(const ArrivalRecord& arrival) override;
  std::optional<std::size_t> serve(std::int64_t now_ns) override;

  void begin_with(const KeptSurface& kept) override { begin_kept(kept, state_); }
  [[nodiscard]] KeptSurface kept() const override { return kept_surface(state_); }
  [[nodiscard]] std::vector<SurfaceDent> dents() const override {
    return surface_dents(state_);
  }

  /// Another local model from the next tick on (switch_model.h).
  void use(LocalModel model) noexcept { switch_model(state_, model); }

 private:
  FastState state_;
  YieldedSites kept_;  // in restart()
  std::unique_ptr<RenderExchange> exchange_ = std::make_unique<RenderExchange>();
  ElementSender& stream_;
  NeedleWatch* watch_;
  FrictionWatch* rubbed_;
};

}  // namespace palpate
