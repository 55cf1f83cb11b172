// puncture of a material, and the needle that punctures it.
#include <numbers>

#include "formats/scene/scene_parts.h"

namespace palpate::scene_parts {
namespace {

constexpr std::string_view kPunctureKeys[] = {
    "toughness_j_per_m2", "friction",   "radial_stress_pa", "friction_n_per_m",
    "static_ratio",       "membrane_n", "membrane_j"};
constexpr std::string_view kHeldKeys[] = {"shaft_n_per_m", "lateral_n_per_m2",
                                          "mouth_m"};

constexpr NumberRule kAtLeastOne{[](double v) {
                                   return v >= 1.0;
                                 },
                                 "at least 1"};
// At 115 degrees a cone that ends in a shaft is as stiff as a hemisphere deep down.
constexpr NumberRule kTipAngle{[](double v) {
                                 return v > 0.0 && v <= 110.0;
                               },
                               "above 0 and at most 110"};

}  // namespace

std::optional<ScenePuncture> read_puncture(const SceneSection& section) {
  if (section.find("puncture") == nullptr) {
    return std::nullopt;
  }
  const SceneSection keys = section.table("puncture", kPunctureKeys);
  const auto optional = [&](std::string_view key) {
    return keys.find(key) == nullptr ? std::optional<double>()
                                     : keys.number(key, kNotNegative);
  };
  ScenePuncture puncture;
  puncture.toughness_j_per_m2 = keys.number("toughness_j_per_m2", kNotNegative);
  puncture.static_ratio = keys.number_or(1.0, "static_ratio", kAtLeastOne);
  puncture.friction_n_per_m = optional("friction_n_per_m");
  puncture.friction = optional("friction");
  puncture.radial_stress_pa = optional("radial_stress_pa");
  if (puncture.friction.has_value() != puncture.radial_stress_pa.has_value() ||
      (puncture.friction && puncture.friction_n_per_m)) {
    keys.fail(
        "{} must have friction and radial_stress_pa, or friction_n_per_m, or none",
        keys.title());
  }
  puncture.membrane_n = optional("membrane_n");
  puncture.membrane_j = optional("membrane_j");
  if (puncture.membrane_n && puncture.membrane_j) {
    keys.fail("{} has membrane_n and membrane_j, must have one", keys.title());
  }
  return puncture;
}

SceneNeedle read_needle(const SceneSection& section) {
  SceneNeedle needle{.radius_m = section.number("radius_m", kPositive),
                     .edge_width_m = section.number("edge_width_m", kPositive)};
  needle.press_radius_m =
      section.number_or(needle.radius_m, "press_radius_m", kPositive);
  if (needle.press_radius_m < needle.radius_m) {
    section.fail("press_radius_m is {} m, must be at least radius_m, {} m",
                 needle.press_radius_m, needle.radius_m);
  }
  if (section.find("tip_angle_deg") != nullptr) {
    needle.tip_angle_rad =
        section.number("tip_angle_deg", kTipAngle) * std::numbers::pi / 180.0;
  }
  needle.mouth_m = needle.radius_m;
  if (section.find("puncture") != nullptr) {
    const SceneSection keys = section.table("puncture", kHeldKeys);
    needle.shaft_n_per_m = keys.number_or(0.0, "shaft_n_per_m", kPositive);
    if (keys.find("lateral_n_per_m2") != nullptr) {
      needle.lateral_n_per_m2 = keys.number("lateral_n_per_m2", kNotNegative);
    }
    needle.mouth_m = keys.number_or(needle.radius_m, "mouth_m", kPositive);
  }
  return needle;
}

}  // namespace palpate::scene_parts
