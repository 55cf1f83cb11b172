// How the force between two slow updates is made.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace palpate {

enum class LocalModel : std::uint8_t {
  kSingle,          ///< zero-order hold of the slow process's force
  kFirstOrderHold,  ///< extrapolates in time from the two latest slow forces
  kEqualEnergy,     ///< linear impedance, relaxed state by (20)-(24)
  kEnergyTank,      ///< tangent impedance, what updates free pays for what they cost
  kElement,    ///< curves at the fast rate in the active element (5.2), with ledger
  kPotential,  ///< their potential field in prism coordinates, with ledger
};

/// Every model, in the order of its value.
constexpr std::array<LocalModel, 6> kLocalModels{
    LocalModel::kSingle,     LocalModel::kFirstOrderHold, LocalModel::kEqualEnergy,
    LocalModel::kEnergyTank, LocalModel::kElement,        LocalModel::kPotential};

/// Whether the model evaluates the body's curves at every tick, in three dimensions;
/// the others go along one direction between slow updates.
[[nodiscard]] constexpr bool follows_surface(LocalModel model) noexcept {
  return model == LocalModel::kElement || model == LocalModel::kPotential;
}

/// Whether the model creates no energy, whatever the tool does and when updates come.
[[nodiscard]] constexpr bool passive(LocalModel model) noexcept {
  return model != LocalModel::kSingle && model != LocalModel::kFirstOrderHold;
}

/// The model's name, as the flag --model and the reports spell it.
[[nodiscard]] constexpr std::string_view name(LocalModel model) noexcept {
  constexpr std::array<std::string_view, 6> kNames{"single",       "first-order-hold",
                                                   "equal-energy", "energy-tank",
                                                   "element",      "potential"};
  return kNames[static_cast<std::size_t>(model)];
}

/// The model of that name; none if there is no such model.
[[nodiscard]] constexpr std::optional<LocalModel> local_model(
    std::string_view text) noexcept {
  for (const LocalModel model : kLocalModels) {
    if (name(model) == text) {
      return model;
    }
  }
  return std::nullopt;
}

}  // namespace palpate
