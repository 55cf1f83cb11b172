#include "formats/response/tool_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"
#include "formats/mesh/convex_mesh.h"

namespace palpate {

namespace {

constexpr double kSmallestM = 1e-9;  // no tool is sharper than atoms

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

void require(const ToolShape& tool, const char* key, double value, bool good,
             const std::string& what) {
  if (!good || !std::isfinite(value)) {
    throw InputError(
        fmt::format("tool {:?}: {} is {}, must be {}", tool.name, key, value, what));
  }
}

void require_positive(const ToolShape& tool, const char* key, double value) {
  require(tool, key, value, value > 0.0, "positive and finite");
}

void require_not_negative(const ToolShape& tool, const char* key, double value) {
  require(tool, key, value, value >= 0.0, "zero or more and finite");
}

void require_none(const ToolShape& tool, const char* key, double value) {
  if (value != 0.0) {
    throw InputError(fmt::format("tool {:?}: {} is {}, but a {} has none", tool.name,
                                 key, value, tool.kind));
  }
}

void check_lengths(const ToolShape& tool) {
  const bool punch = tool.kind == "flat-punch";
  const bool cone = tool.kind == "cone";
  const bool capsule = tool.kind == "capsule";
  if (punch || capsule || tool.kind == "sphere") {
    require_positive(tool, "radius_m", tool.radius_m);
    require(tool, "radius_m", tool.radius_m, tool.radius_m >= kSmallestM,
            "at least 1e-9 m");
  } else {
    require_none(tool, "radius_m", tool.radius_m);
  }
  if (punch) {
    require(tool, "edge_radius_m", tool.edge_radius_m,
            tool.edge_radius_m >= 0.0 && tool.edge_radius_m < tool.radius_m,
            fmt::format("zero or more and below radius_m = {}", tool.radius_m));
  } else {
    require_none(tool, "edge_radius_m", tool.edge_radius_m);
  }
  if (cone) {
    require(tool, "half_angle_rad", tool.half_angle_rad,
            tool.half_angle_rad > 0.0 && tool.half_angle_rad < 0.5 * std::numbers::pi,
            "above 0 and below pi/2");
    require_not_negative(tool, "tip_radius_m", tool.tip_radius_m);
    require_not_negative(tool, "length_m", tool.length_m);
  } else {
    require_none(tool, "half_angle_rad", tool.half_angle_rad);
    require_none(tool, "tip_radius_m", tool.tip_radius_m);
  }
  if (capsule) {
    require_positive(tool, "length_m", tool.length_m);
  } else if (!cone) {
    require_none(tool, "length_m", tool.length_m);
  }
}

void check_apart(const ToolShape& tool) {
  const Points& point_m = tool.contact.point_m;
  for (Eigen::Index i = 0; i < point_m.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (point_m.row(i) == point_m.row(j)) {
        throw InputError(fmt::format(
            "tool {:?}: contact spheres {} and {} have one centre, must be apart",
            tool.name, j, i));
      }
    }
  }
}

void check_contacts(const ToolShape& tool) {
  const ContactSet& set = tool.contact;
  if (set.empty() && set.point_m.size() == 0) {
    return;
  }
  if (tool.kind != "sphere") {
    throw InputError(
        fmt::format("tool {:?}: a {} has no contact spheres, must be a "
                    "sphere",
                    tool.name, tool.kind));
  }
  const auto count = std::ssize(set.radius_m);
  if (count != set.point_m.rows() || count < 1 || count > kMostContacts) {
    throw InputError(fmt::format(
        "tool {:?}: has {} centres and {} radii of contact spheres, must have as many, "
        "1 to {}",
        tool.name, set.point_m.rows(), count, kMostContacts));
  }
  if (set.radius_m.front() != tool.radius_m) {
    throw InputError(fmt::format(
        "tool {:?}: radius_m is {}, must be that of its first contact sphere: {}",
        tool.name, tool.radius_m, set.radius_m.front()));
  }
  for (std::int64_t i = 0; i < count; ++i) {
    const double radius_m = set.radius_m[static_cast<std::size_t>(i)];
    require(tool, "radius_m of a contact sphere", radius_m, radius_m >= kSmallestM,
            "at least 1e-9 m");
    if (!set.point_m.row(i).allFinite()) {
      throw InputError(
          fmt::format("tool {:?}: the centre of contact sphere {} is not "
                      "finite",
                      tool.name, i));
    }
  }
  check_apart(tool);
}

void check_friction(const ToolShape& tool) {
  if (!(tool.friction >= 0.0 && tool.friction <= 10.0)) {
    throw InputError(fmt::format("tool {:?}: friction is {}, must lie in [0, 10]",
                                 tool.name, tool.friction));
  }
  require_not_negative(tool, "presliding_m", tool.presliding_m);
  if (tool.friction > 0.0 && tool.presliding_m == 0.0 && !tool.presliding_computed) {
    throw InputError(
        fmt::format("tool {:?}: friction {} needs presliding_m > 0, the displacement "
                    "before sliding",
                    tool.name, tool.friction));
  }
}

}  // namespace

void check_without_mesh(const ToolShape& tool) {
  check_tool_name(tool.name);
  if (std::find(kToolKinds.begin(), kToolKinds.end(), tool.kind) == kToolKinds.end()) {
    throw InputError(
        fmt::format("tool {:?}: shape {:?} is not available; available: {}", tool.name,
                    tool.kind, fmt::join(kToolKinds, ", ")));
  }
  check_lengths(tool);
  if (tool.axis && !(std::abs(tool.axis->norm() - 1.0) <= 1e-9)) {
    throw InputError(
        fmt::format("tool {:?}: axis has the length {}, must be a unit vector",
                    tool.name, tool.axis->norm()));
  }
  check_friction(tool);
  check_contacts(tool);
}

void check(const ToolShape& tool) {
  check_without_mesh(tool);
  if (tool.kind == "mesh") {
    try {
      require_convex(tool.mesh);
    } catch (const InputError& error) {
      throw InputError(fmt::format("tool {:?}: {}", tool.name, error.what()));
    }
  } else if (tool.mesh.triangle.rows() > 0) {
    throw InputError(
        fmt::format("tool {:?}: a {} has no mesh of its own", tool.name, tool.kind));
  }
}

std::string describe(const ToolShape& tool) {
  std::string text = tool.kind;
  const char* joint = " of ";
  const auto add = [&](const std::string& part) {
    text += joint + part;
    joint = ", ";
  };
  const auto add_length = [&](const char* what, double length_m) {
    if (length_m > 0.0) {
      add(fmt::format("{} {:.4g} mm", what, 1e3 * length_m));
    }
  };
  add_length("radius", tool.radius_m);
  add_length("edge radius", tool.edge_radius_m);
  if (tool.half_angle_rad > 0.0) {
    add(fmt::format("half-angle {:.4g} deg",
                    tool.half_angle_rad * 180.0 / std::numbers::pi));
  }
  add_length("tip radius", tool.tip_radius_m);
  add_length(tool.kind == "cone" ? "height" : "length", tool.length_m);
  if (tool.kind == "mesh") {
    add(fmt::format("{} triangles", tool.mesh.triangle.rows()));
  }
  if (!tool.contact.empty()) {
    add(fmt::format("{} contacts", tool.contact.radius_m.size()));
  }
  if (tool.axis) {
    add(fmt::format("axis ({:.3g}, {:.3g}, {:.3g})", tool.axis->x(), tool.axis->y(),
                    tool.axis->z()));
  }
  if (tool.sticking) {
    add("sticking");
  }
  return text;
}

}  // namespace palpate
