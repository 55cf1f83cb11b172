#include "formats/tool_shape.h"

#include <cmath>

#include <fmt/format.h>

#include "formats/error.h"

namespace palpate {

void check(const ToolShape& tool) {
  if (tool.kind != "sphere") {
    throw InputError(
        fmt::format("tool \"{}\": shape \"{}\" is not available; available: sphere",
                    tool.name, tool.kind));
  }
  if (!(tool.radius_m > 0.0) || !std::isfinite(tool.radius_m)) {
    throw InputError(
        fmt::format("tool \"{}\": radius_m is {}, must be positive and finite",
                    tool.name, tool.radius_m));
  }
  if (!(tool.friction >= 0.0 && tool.friction <= 10.0)) {
    throw InputError(fmt::format("tool \"{}\": friction is {}, must lie in [0, 10]",
                                 tool.name, tool.friction));
  }
  if (!(tool.presliding_m >= 0.0) || !std::isfinite(tool.presliding_m)) {
    throw InputError(
        fmt::format("tool \"{}\": presliding_m is {}, must be zero or more and finite",
                    tool.name, tool.presliding_m));
  }
  if (tool.friction > 0.0 && tool.presliding_m == 0.0) {
    throw InputError(
        fmt::format("tool \"{}\": friction {} needs presliding_m > 0, the displacement "
                    "before sliding",
                    tool.name, tool.friction));
  }
}

}  // namespace palpate
