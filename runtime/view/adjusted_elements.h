// A slow process whose body is made stiffer, softer or more slippery by hand.
#pragma once

#include <memory>
#include <optional>

#include "runtime/element/element.h"
#include "runtime/slow/element_source.h"

namespace palpate {

/// Multiplies what a node answers with, and replaces its friction where one is given.
void adjust_node(ElementNode& node, double scale, std::optional<double> friction);

/// Passes elements on with forces, slopes and energies multiplied and friction
/// replaced. What the fast process has already stays as it is until the next slow
/// update. That update is a change of the body like any other, which the ledger
/// balances.
class AdjustedStream : public ElementSender {
 public:
  /// `stream` must outlive this.
  explicit AdjustedStream(ElementSender& stream) : stream_(stream) {}

  void set_stiffness_scale(double scale) noexcept { scale_ = scale; }  ///< [-] > 0
  /// [-] >= 0 at every node; none: the database's.
  void set_friction(std::optional<double> friction) noexcept { friction_ = friction; }

  [[nodiscard]] double stiffness_scale() const noexcept { return scale_; }
  [[nodiscard]] std::optional<double> friction() const noexcept { return friction_; }

  std::size_t update(const ToolState& tool, std::int64_t now_ns,
                     ElementFifo& fifo) override;

  [[nodiscard]] PunctureRules puncture() const override { return stream_.puncture(); }

 private:
  ElementSender& stream_;
  std::unique_ptr<ElementFifo> unchanged_ = std::make_unique<ElementFifo>();
  double scale_ = 1.0;
  std::optional<double> friction_;
};

}  // namespace palpate
