// The curve of a needle before its puncture, from the press of a larger ball.
//
// A mesh as fine as a tip needs costs much more than one for a ball. Close to the tip
// the body is a half-space of the tissue there. Farther away the body does not know
// the radius. So at one force F the depths of needle and ball differ as they do in the
// half-space:
//
//   D(F) = D_ball(F) + h(F; R) - h(F; R_ball)
//
// h is the depth at which a half-space bears F under the shaft: with a hemispherical
// tip, or with a conical one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/response/response_table.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/tip_depth.h"

namespace palpate {

/// [-] The error of the force over the difference of depths by the depth. Found against
/// presses of small balls themselves (tests/bench/needle_curve, --coverage). Most need
/// a quarter of it. Stiff skins that are thinner than the tip's radius need all of it.
inline constexpr double kSharpenError = 1.2;

/// Makes a needle's response of that of its ball: forces stay, depths grow. The tilt
/// stays at each force. The error grows by kSharpenError.
/// @param response of a ball of `ball_m`. @param tip no wider than the ball.
/// @param nonlinear the ball was pressed so. A cone's depth over a hemisphere's stays
/// linear.
void sharpen(const TipTissue& tissue, const NeedleTip& tip, double ball_m,
             bool nonlinear, NodeResponse& response);

/// A sentence for each needle that a scene presses deeper than was compared.
[[nodiscard]] std::vector<std::string> needle_notes(const Scene& scene);

/// The tissue right below a vertex.
[[nodiscard]] TipTissue tissue_at(const BodySource& body, std::int32_t vertex);

}  // namespace palpate
