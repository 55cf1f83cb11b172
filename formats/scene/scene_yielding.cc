// plastic and damage, of a material or a tool: how responses yield for good.
#include "formats/scene/scene_parts.h"

namespace palpate::scene_parts {

SceneYielding read_yielding(const SceneSection& section) {
  constexpr std::string_view kPlasticKeys[] = {"yield_depth_m", "share"};
  constexpr std::string_view kDamageKeys[] = {"onset_m", "scale_m", "largest"};
  SceneYielding yielding;
  if (section.find("plastic") != nullptr) {
    const SceneSection plastic = section.table("plastic", kPlasticKeys);
    yielding.plastic = {.yield_depth_m = plastic.number("yield_depth_m", kNotNegative),
                        .share = plastic.number("share", kBelowOne)};
  }
  if (section.find("damage") != nullptr) {
    const SceneSection damage = section.table("damage", kDamageKeys);
    yielding.damage = {.onset_m = damage.number("onset_m", kNotNegative),
                       .scale_m = damage.number("scale_m", kPositive),
                       .largest = damage.number("largest", kBelowOne)};
  }
  return yielding;
}

}  // namespace palpate::scene_parts
