// The slow process of several contacts on an adjusted body. The body is made stiffer,
// softer or more slippery by hand, and its coupling is switched off to see what the
// coupling does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "runtime/slow/contact_elements.h"

namespace palpate {

/// As AdjustedStream; rows of compliance go with the stiffness, and are zero where
/// contacts shall not couple: then each presses a body of its own. What is set holds
/// for what is sent from then on (SeveralContacts::renew() sends all anew).
class AdjustedContacts : public ContactSender {
 public:
  /// @throws as coupled_set(). The database must outlive this.
  AdjustedContacts(const ResponseDatabase& database,
                   std::span<const ResponseTable* const> tools)
      : stream_(database, tools) {}

  [[nodiscard]] const CoupledSet& set() const noexcept override {
    return stream_.set();
  }

  void set_stiffness_scale(double scale) noexcept { scale_ = scale; }  ///< [-] > 0
  /// [-] >= 0 at every node; none: the database's.
  void set_friction(std::optional<double> friction) noexcept { friction_ = friction; }
  void set_coupled(bool coupled) noexcept { coupled_ = coupled; }

  [[nodiscard]] double stiffness_scale() const noexcept { return scale_; }
  [[nodiscard]] std::optional<double> friction() const noexcept { return friction_; }
  [[nodiscard]] bool coupled() const noexcept { return coupled_; }

  std::size_t update(const ContactToolState& tool, std::int64_t now_ns,
                     ContactFifo& fifo, ContactSent& sent) override;
  [[nodiscard]] std::optional<ContactElement> element_of(
      int i, std::int32_t triangle) const override;

  /// The message of a triangle for contact i, whether contacts couple at the moment or
  /// not. @param coupled with the body's rows of compliance; without: of zeros.
  [[nodiscard]] ContactElement element(int i, std::int32_t triangle,
                                       bool coupled) const;

 private:
  void adjust(ContactElement& message, bool coupled) const;

  ContactStream stream_;
  std::unique_ptr<ContactFifo> unchanged_ = std::make_unique<ContactFifo>();
  double scale_ = 1.0;
  std::optional<double> friction_;
  bool coupled_ = true;
};

}  // namespace palpate
