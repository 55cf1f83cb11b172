// The memory of a coupled fast process, made at set-up.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/contacts/coupled_step.h"

namespace palpate {

/// A state with what it points to: about 4 MB, and 0.4 MB for each contact.
class CoupledStorage {
 public:
  /// @param set finished. @throws InputError.
  CoupledStorage(const CoupledSet& set, const FastConfig& config)
      : state_(std::make_unique<CoupledState>()),
        surfaces_(is_alone(set) ? 0 : static_cast<std::size_t>(set.count)) {
    if (const char* wrong = check(set, config)) {
      throw InputError(fmt::format("contacts: {}", wrong));
    }
    if (is_alone(set)) {
      alone_ = std::make_unique<FastState>();
    }
    state_->config = config;
    state_->set = set;
    state_->surfaces = surfaces_.data();
    state_->alone = alone_.get();
    begin(*state_);
  }

  [[nodiscard]] CoupledState& state() noexcept { return *state_; }
  [[nodiscard]] const CoupledState& state() const noexcept { return *state_; }

 private:
  std::unique_ptr<CoupledState> state_;
  std::vector<CoupledSurface> surfaces_;
  std::unique_ptr<FastState> alone_;
};

}  // namespace palpate
