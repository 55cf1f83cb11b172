// A tool of several contacts, or two hands, on a body that pages change.
//
// What is set while tools press changes the body for all contacts at one tick. The
// ledger books the change. What stored energy and tank do not pay is taken by delta_0
// until the contacts have been lifted.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "runtime/render/several_contacts.h"
#include "runtime/view/adjusted_contacts.h"
#include "runtime/view/steered_body.h"
#include "runtime/view/view_dents.h"

namespace palpate {

class SteeredContacts : public SteeredBody {
 public:
  /// The database must outlive it. @param tools one for each hand. @throws as
  /// coupled_set().
  SteeredContacts(const ResponseDatabase& database,
                  const std::vector<const ResponseTable*>& tools,
                  const FastConfig& config, KeptSurface surface);

  void begin() override;
  [[nodiscard]] RenderedBody& rendered() override { return *body_; }
  [[nodiscard]] const RenderedBody& rendered() const override { return *body_; }
  void limit(double force_max_n, double ramp_s) override {
    config_.force_max_n = force_max_n;
    config_.ramp_s = ramp_s;
  }
  void set(const ViewRequest& request) override;
  [[nodiscard]] std::int32_t triangle_under(std::size_t hand,
                                            const TickRecord& latest) const override;
  [[nodiscard]] bool turns() const noexcept override { return true; }
  void tell(ViewSettings& settings) const override;
  void show(const std::vector<SteeredHand>& hand, ViewFrame& frame) override;

  /// Wrenches of the body on the tools at the present poses, without friction and
  /// delta_0, with contacts that couple or do not. There are none where that has no
  /// solution or nothing has been sampled.
  [[nodiscard]] std::optional<PortWrenches> elastic(bool coupled);

  [[nodiscard]] const CoupledState& state() const noexcept {
    return std::as_const(*body_).state();
  }

 private:
  [[nodiscard]] std::vector<ViewTouch> touches() const;
  [[nodiscard]] std::vector<NodeDent> dents() const;

  const ResponseDatabase& database_;
  FastConfig config_;
  KeptSurface surface_;
  std::vector<ViewDents> dents_;  // of each radius of each tool
  std::shared_ptr<AdjustedContacts> adjusted_;
  std::unique_ptr<SeveralContacts> body_;
  std::unique_ptr<CoupledField> scratch_ = std::make_unique<CoupledField>();
};

}  // namespace palpate
