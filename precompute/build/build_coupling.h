// How contacts couple through a built body, and how right that is.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/process/progress.h"

namespace palpate {

/// Gives every tool that couples the body's table of compliance, with its error: what
/// 95 % of jointly pressed sets are within, the tool's own or all tools', whichever is
/// more. The errors' tail is where a body gives way as a whole, under any of them, and
/// more sets know it better.
/// A set that cannot be pressed misses it; where too many do, none is stated.
/// @param database with responses of the scene's tools.
/// @returns what to know about it, a line each.
std::vector<std::string> add_coupling(const Scene& scene, const BodySource& body,
                                      std::span<const std::int32_t> reachable,
                                      ResponseDatabase& database, Progress& progress);

}  // namespace palpate
