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

/// Gives every tool that couples the body's table of compliance, with the table's
/// error. 95 % of jointly pressed sets are within the error: the tool's own sets or all
/// tools', whichever error is more. The errors' tail is where a body deforms as a
/// whole, under any of the tools, and more sets know the tail better. A set that cannot
/// be pressed counts as a miss. Where too many sets miss, no error is stated.
/// @param database with responses of the scene's tools.
/// @returns what to know about the table, a line each.
std::vector<std::string> add_coupling(const Scene& scene, const BodySource& body,
                                      std::span<const std::int32_t> reachable,
                                      ResponseDatabase& database, Progress& progress);

}  // namespace palpate
