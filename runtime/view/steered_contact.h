// A tool of one contact on a body that pages change.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "formats/mesh/surface_search.h"
#include "runtime/fast/fast_step.h"
#include "runtime/render/one_contact.h"
#include "runtime/slow/memory_elements.h"
#include "runtime/view/adjusted_elements.h"
#include "runtime/view/steered_body.h"

namespace palpate {

class SteeredContact : public SteeredBody {
 public:
  /// All must outlive it; `table` is of the database. @param growing elements of a body
  /// whose responses are not in the database; null: they are.
  SteeredContact(const ResponseDatabase& database, const ResponseTable& table,
                 const FastConfig& config, KeptSurface surface, ElementSender* growing);

  void begin() override;
  [[nodiscard]] RenderedBody& rendered() override { return *body_; }
  [[nodiscard]] const RenderedBody& rendered() const override { return *body_; }
  void limit(double force_max_n, double ramp_s) override {
    config_.force_max_n = force_max_n;
    config_.ramp_s = ramp_s;
  }
  void set(const ViewRequest& request) override;
  [[nodiscard]] std::int32_t triangle_under(std::size_t /*hand*/,
                                            const TickRecord& latest) const override {
    return latest.triangle;
  }
  [[nodiscard]] std::optional<Channel> channel() const override {
    const NeedleSeen needle = body_->needle();
    const Channel* in = channel_of(needle.state);
    return in == nullptr ? std::nullopt : std::optional(*in);
  }
  [[nodiscard]] bool turns() const noexcept override { return false; }
  void tell(ViewSettings& settings) const override;
  void show(const std::vector<SteeredHand>& hand, ViewFrame& frame) override;

 private:
  const ResponseDatabase& database_;
  const ResponseTable& table_;
  FastConfig config_;
  KeptSurface surface_;
  ElementStream stream_;
  AdjustedStream adjusted_;
  ViewDents dents_;
  std::optional<ViewNeedle> needle_;  // of the latest frame
  std::unique_ptr<OneContact> body_;
};

}  // namespace palpate
