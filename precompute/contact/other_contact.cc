#include "precompute/contact/other_contact.h"

#include <algorithm>

namespace palpate {

bool reaches_elsewhere(const ContactSurface& surface,
                       std::span<const std::int32_t> patch, const IndentationPath& path,
                       double touch_m) {
  const double within_m = -0.1 * path.depth_max_m;
  const PlacedTool touching = tool_at(path, touch_m);
  const PlacedTool deepest = tool_at(path, path.depth_max_m);
  for (std::size_t v = 0; v < surface.node.size(); ++v) {
    if (std::binary_search(patch.begin(), patch.end(), static_cast<std::int32_t>(v))) {
      continue;
    }
    const ContactNode& node = surface.node[v];
    if (distance(touching, node.position_m).distance_m < within_m) {
      return true;
    }
    const ToolDistance to_tool = distance(deepest, node.position_m);
    if (to_tool.distance_m < within_m && to_tool.normal.dot(node.normal) < 0.0) {
      return true;
    }
  }
  return false;
}

}  // namespace palpate
