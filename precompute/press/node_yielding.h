// How each node's response yields, from the materials and tools of a scene.
//
// A tool's own parameters hold for all of its nodes. Else a node takes the material
// that lies under it, half a contact radius deep along its normal. The shear of a
// ball's contact is largest there (0.48 a; Johnson 1985). A cavity counts as the region
// around it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/response/viscoelasticity.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"

namespace palpate {

/// Region of a point of the body: 0 is the body itself. In region i + 1 the point lies
/// in inner surface or layer i, and in no smaller one. Cavities are passed over.
[[nodiscard]] std::int32_t region_of(const BodySource& body,
                                     const Eigen::Vector3d& p_m);

/// By tool; one row where all nodes have the same, none where nothing yields.
/// @throws InputError for a yield depth or an onset past the scene's largest depth:
/// nothing would yield.
[[nodiscard]] std::vector<Yielding> node_yielding(const Scene& scene,
                                                  const BodySource& body);

}  // namespace palpate
