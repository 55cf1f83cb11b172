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
  kPotential,  ///< their smooth potential field, with ledger
  kFacets,     ///< the same, linear over flat facets: forces step at their edges
};

/// Every model, in the order of its value.
constexpr std::array<LocalModel, 7> kLocalModels{
    LocalModel::kSingle,     LocalModel::kFirstOrderHold, LocalModel::kEqualEnergy,
    LocalModel::kEnergyTank, LocalModel::kElement,        LocalModel::kPotential,
    LocalModel::kFacets};

/// Whether the model renders a potential field, of one contact or several.
[[nodiscard]] constexpr bool is_field(LocalModel model) noexcept {
  return model == LocalModel::kPotential || model == LocalModel::kFacets;
}

/// How such a field interpolates between nodes.
enum class FieldKind : std::uint8_t {
  kSmooth,  ///< smooth_triangle.h
  kFacets,  ///< prism.h
};

[[nodiscard]] constexpr FieldKind field_kind(LocalModel model) noexcept {
  return model == LocalModel::kFacets ? FieldKind::kFacets : FieldKind::kSmooth;
}

/// Whether the model evaluates the body's curves at every tick, in three dimensions;
/// the others go along one direction between slow updates.
[[nodiscard]] constexpr bool follows_surface(LocalModel model) noexcept {
  return model == LocalModel::kElement || is_field(model);
}

/// Whether the model creates no energy, whatever the tool does and when updates come.
[[nodiscard]] constexpr bool passive(LocalModel model) noexcept {
  return model != LocalModel::kSingle && model != LocalModel::kFirstOrderHold;
}

/// The model's name, as the flag --model and the reports spell it.
[[nodiscard]] constexpr std::string_view name(LocalModel model) noexcept {
  constexpr std::array<std::string_view, 7> kNames{
      "single",  "first-order-hold", "equal-energy", "energy-tank",
      "element", "potential",        "facets"};
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
