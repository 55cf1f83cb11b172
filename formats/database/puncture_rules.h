// The rules of FORMAT.md for what a needle breaks, cuts and rubs against.
#pragma once

#include <cstdint>
#include <string>

#include "formats/response/puncture.h"

namespace palpate {

/// All of a tool's puncture; nothing where the tool has none.
/// @param tool the group: "/tools/needle". @param nodes of the body.
/// @throws FormatError naming the dataset, the row, its value and what it must be.
void check_puncture(const std::string& tool, const Puncture& puncture,
                    std::int64_t nodes);

}  // namespace palpate
