// What a scene's needles meet below each node: forces of membranes and of cutting, and
// the layers of materials along the node's axis.
#pragma once

#include <vector>

#include "formats/response/puncture.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"

namespace palpate {

/// By tool; empty for one that is no needle.
///
/// The axis runs along the node's inward normal. Layers begin where the axis crosses an
/// inner surface, or passes below a layer of the scene; a cavity counts as what is
/// around it. Cutting takes J w, toughness times the edge's width (Okamura 2004). A
/// material without puncture cannot be entered. Stiffness across the shaft is that of a
/// beam on an elastic half-space, 0.65 E / (1 - nu^2) per length, unless stated.
/// @throws InputError for a needle whose first materials mix forces and energies of
/// membranes, and for more materials or layers than a needle can have.
[[nodiscard]] std::vector<Puncture> needle_layers(const Scene& scene,
                                                  const BodySource& body);

}  // namespace palpate
