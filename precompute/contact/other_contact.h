// Whether a tool meets a part of the body that its press does not know.
#pragma once

#include <cstdint>
#include <span>

#include "precompute/contact/contact_surface.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// A press knows the contact nodes of its patch (contact_patch): those joined to the
/// vertex over the surface, facing the tool and free. The tool may also reach into the
/// opposite wall of a fold, a neighbouring lobe, a step beside the vertex, a held face.
/// What it does there is not in the response: its force is too small.
///
/// True if a contact node outside the patch lies in the tool by more than a tenth of
/// the largest depth. The body is at rest and the tool at first touch, or at the
/// largest depth. At the largest depth a node counts only if it faces the tool (tool's
/// normal . node's normal < 0). The far side of a thin part, which the tool passes
/// through there, does not face the tool.
/// @param patch ascending.
[[nodiscard]] bool reaches_elsewhere(const ContactSurface& surface,
                                     std::span<const std::int32_t> patch,
                                     const IndentationPath& path, double touch_m);

}  // namespace palpate
