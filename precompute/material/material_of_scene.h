// The constitutive law that a scene's material names.
#pragma once

#include "formats/scene/scene.h"
#include "precompute/material/material.h"

namespace palpate {

/// @throws InputError naming the region and the constant that is out of range.
[[nodiscard]] Material make_material(const SceneMaterial& material);

}  // namespace palpate
