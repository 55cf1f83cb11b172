#include "formats/tool_shape.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/error.h"

namespace palpate {

namespace {

// A name is also a group in the database and a word on the command line.
void check_tool_name(const std::string& name) {
  const auto allowed = [](unsigned char c) {
    return c > 0x20 && c != 0x7f && c != '/';
  };
  if (name.empty() || name.size() > 64 || name.front() == '.' ||
      !std::all_of(name.begin(), name.end(), allowed)) {
    throw InputError(
        fmt::format("tool name {:?} cannot be used, must have 1 to 64 characters, no "
                    "blank, no '/', no '.' at its start",
                    name));
  }
}

}  // namespace

void check(const ToolShape& tool) {
  check_tool_name(tool.name);
  if (tool.kind != "sphere") {
    throw InputError(
        fmt::format("tool {:?}: shape {:?} is not available; available: sphere",
                    tool.name, tool.kind));
  }
  if (!(tool.radius_m > 0.0) || !std::isfinite(tool.radius_m)) {
    throw InputError(
        fmt::format("tool {:?}: radius_m is {}, must be positive and finite", tool.name,
                    tool.radius_m));
  }
  if (!(tool.friction >= 0.0 && tool.friction <= 10.0)) {
    throw InputError(fmt::format("tool {:?}: friction is {}, must lie in [0, 10]",
                                 tool.name, tool.friction));
  }
  if (!(tool.presliding_m >= 0.0) || !std::isfinite(tool.presliding_m)) {
    throw InputError(
        fmt::format("tool {:?}: presliding_m is {}, must be zero or more and finite",
                    tool.name, tool.presliding_m));
  }
  if (tool.friction > 0.0 && tool.presliding_m == 0.0) {
    throw InputError(
        fmt::format("tool {:?}: friction {} needs presliding_m > 0, the displacement "
                    "before sliding",
                    tool.name, tool.friction));
  }
}

}  // namespace palpate
