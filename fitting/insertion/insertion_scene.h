// What an insertion was fitted to, as keys of a scene (formats/scene/SCENE.md).
#pragma once

#include <string>

#include "fitting/insertion/needle_fit.h"

namespace palpate {

/// TOML: a [[layer]] and a [[material]] for each layer but the deepest, which is the
/// body's, and the keys of the needle's [[tool]]. A scene adds laws and moduli. What
/// was refused has a comment with the reason in place of its key.
/// @param edge_width_m [m] > 0. @throws InputError where a layer's cutting force or a
/// boundary was refused, because a scene has none without them.
[[nodiscard]] std::string insertion_scene(const NeedleFit& fit, double edge_width_m);

}  // namespace palpate
