#include "fitting/material/indenter.h"

namespace palpate {

std::optional<ToolShape> rendered_tool(const Indenter& indenter) {
  if (indenter.shape == "plate" || indenter.shape == "unknown") {
    return std::nullopt;
  }
  ToolShape tool;
  tool.name = "probe";
  tool.kind = indenter.shape;
  tool.radius_m = indenter.radius_m;
  tool.half_angle_rad = indenter.half_angle_rad;
  return tool;
}

}  // namespace palpate
