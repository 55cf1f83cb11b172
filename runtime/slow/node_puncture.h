// What the fast process needs to know of a needle: rules of the tool, layers of a node.
#pragma once

#include <cstdint>

#include "formats/response/puncture.h"
#include "runtime/element/element.h"
#include "runtime/needle/channel.h"

namespace palpate {

/// Rules of a tool that punctures; of one that does not, none.
/// @param force_scale [-] (0, 1] that forces of the database are multiplied by.
[[nodiscard]] PunctureRules puncture_rules(const Puncture& puncture,
                                           double force_scale);

/// Layers below a node. @param node as the file counts; a row of its own, or the row
/// of all.
[[nodiscard]] NodePuncture node_puncture(const Puncture& puncture, std::int64_t node,
                                         double force_scale);

}  // namespace palpate
