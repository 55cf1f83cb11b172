// [[tool]]: who presses.
#include <algorithm>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/scene/scene_parts.h"

namespace palpate::scene_parts {
namespace {

constexpr std::string_view kToolKeys[] = {
    "name",         "shape",    "radius_m",     "edge_radius_m", "half_angle_deg",
    "tip_radius_m", "length_m", "mesh",         "length_unit",   "axis",
    "contact",      "friction", "presliding_m", "plastic",       "damage"};
constexpr std::string_view kSharedKeys[] = {"name",    "shape",    "axis",
                                            "contact", "friction", "presliding_m",
                                            "plastic", "damage"};
constexpr std::string_view kSphereKeys[] = {"radius_m"};
constexpr std::string_view kPunchKeys[] = {"radius_m", "edge_radius_m"};
constexpr std::string_view kConeKeys[] = {"half_angle_deg", "tip_radius_m", "length_m"};
constexpr std::string_view kCapsuleKeys[] = {"radius_m", "length_m"};
constexpr std::string_view kMeshKeys[] = {"mesh", "length_unit"};
constexpr std::string_view kContacts[] = {"frictionless", "sticking"};

constexpr NumberRule kFriction{[](double v) {
                                 return v >= 0.0 && v <= 10.0;
                               },
                               "in [0, 10]"};
constexpr NumberRule kHalfAngle{[](double v) {
                                  return v > 0.0 && v < 90.0;
                                },
                                "above 0 and below 90"};

Names keys_of(const std::string& kind) {
  if (kind == "flat-punch") {
    return kPunchKeys;
  }
  if (kind == "cone") {
    return kConeKeys;
  }
  if (kind == "capsule") {
    return kCapsuleKeys;
  }
  return kind == "mesh" ? Names(kMeshKeys) : Names(kSphereKeys);
}

void read_lengths(const SceneSection& section, ToolShape& tool) {
  section.require_own(fmt::format("shape {:?}", tool.kind), keys_of(tool.kind),
                      kSharedKeys);
  if (tool.kind == "cone") {
    tool.half_angle_rad =
        section.number("half_angle_deg", kHalfAngle) * std::numbers::pi / 180.0;
    tool.tip_radius_m = section.number_or(0.0, "tip_radius_m", kNotNegative);
    tool.length_m = section.number_or(0.0, "length_m", kPositive);
  } else if (tool.kind != "mesh") {
    tool.radius_m = section.number("radius_m", kPositive);
    tool.edge_radius_m = section.number_or(0.0, "edge_radius_m", kNotNegative);
    if (tool.kind == "capsule") {
      tool.length_m = section.number("length_m", kPositive);
    }
  }
}

ToolShape read_tool(const SceneSection& section) {
  ToolShape tool;
  tool.name = section.text("name");
  tool.kind = section.choice("shape", kToolKinds);
  read_lengths(section, tool);
  if (section.find("axis") != nullptr) {
    tool.axis = section.direction("axis");
  }
  tool.sticking = section.choice_or("frictionless", "contact", kContacts) == "sticking";
  tool.friction = section.number_or(0.0, "friction", kFriction);
  tool.presliding_m = section.number_or(0.0, "presliding_m", kNotNegative);
  return tool;
}

}  // namespace

void read_tools(const Sections& sections, Scene& scene) {
  for (const SceneSection& section : sections.all("tool", kToolKeys)) {
    const ToolShape tool = read_tool(section);
    for (const ToolShape& other : scene.tool) {
      if (other.name == tool.name) {
        section.fail(section.need("name"), "the name {:?} belongs to two tools",
                     tool.name);
      }
    }
    try {
      check_without_mesh(tool);
    } catch (const InputError& error) {
      section.fail("{}", error.what());
    }
    scene.tool.push_back(tool);
    scene.tool_yielding.push_back(read_yielding(section));
    scene.tool_mesh.push_back(
        tool.kind == "mesh" ? read_mesh_keys(section, sections.file()) : SceneMesh{});
  }
}

}  // namespace palpate::scene_parts
