// [[tool]]: who presses.
#include <algorithm>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/contact_set.h"
#include "formats/scene/scene_parts.h"

namespace palpate::scene_parts {
namespace {

constexpr std::string_view kToolKeys[] = {
    "name",         "shape",      "radius_m",     "edge_radius_m",  "half_angle_deg",
    "tip_radius_m", "length_m",   "mesh",         "length_unit",    "axis",
    "contact",      "friction",   "presliding_m", "plastic",        "damage",
    "centre_m",     "compliance", "edge_width_m", "press_radius_m", "puncture",
    "tip_angle_deg"};
constexpr std::string_view kNeedle = "needle";
constexpr std::string_view kNeedleKeys[] = {"radius_m", "tip_angle_deg", "edge_width_m",
                                            "press_radius_m", "puncture"};
constexpr std::string_view kSpheres = "spheres";
constexpr std::string_view kShapes[] = {"sphere",  "spheres", "flat-punch", "cone",
                                        "capsule", "mesh",    kNeedle};
constexpr std::string_view kSharedShapeKeys[] = {"name",    "shape",    "axis",
                                                 "contact", "friction", "presliding_m",
                                                 "plastic", "damage"};
constexpr std::string_view kSphereKeys[] = {"radius_m", "compliance"};
constexpr std::string_view kSpheresKeys[] = {"centre_m", "radius_m"};
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
                      kSharedShapeKeys);
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

// radius_m is a number for all spheres, or a list of one for each.
ContactSet read_contacts(const SceneSection& section) {
  section.require_own("shape \"spheres\"", kSpheresKeys, kSharedShapeKeys);
  constexpr auto kMost = static_cast<std::size_t>(kMostContacts);
  ContactSet contact;
  contact.point_m = section.points("centre_m", kMost);
  const auto count = static_cast<std::size_t>(contact.point_m.rows());
  if (section.need("radius_m").is_array()) {
    contact.radius_m = section.numbers("radius_m", kPositive, kMost);
    if (contact.radius_m.size() != count) {
      section.fail(section.need("radius_m"),
                   "radius_m in {} has {} numbers, must have one for each of the {} "
                   "centres, or be one number",
                   section.title(), contact.radius_m.size(), count);
    }
  } else {
    contact.radius_m.assign(count, section.number("radius_m", kPositive));
  }
  return contact;
}

ToolShape read_tool(const SceneSection& section) {
  ToolShape tool;
  tool.name = section.text("name");
  tool.kind = section.choice("shape", kShapes);
  if (tool.kind == kSpheres) {
    tool.kind = "sphere";
    tool.contact = read_contacts(section);
    tool.radius_m = tool.contact.radius_m.front();
  } else if (tool.kind == kNeedle) {
    section.require_own("shape \"needle\"", kNeedleKeys, kSharedShapeKeys);
    tool.kind = "sphere";
    tool.radius_m = read_needle(section).press_radius_m;
  } else {
    read_lengths(section, tool);
  }
  if (section.find("axis") != nullptr) {
    tool.axis = section.direction("axis");
  }
  tool.sticking = section.choice_or("frictionless", "contact", kContacts) == "sticking";
  tool.friction = section.number_or(0.0, "friction", kFriction);
  tool.presliding_m = section.number_or(0.0, "presliding_m", kNotNegative);
  tool.presliding_computed =
      tool.friction > 0.0 && section.find("presliding_m") == nullptr;
  return tool;
}

void add_tool(const SceneSection& section, const ToolShape& tool, Scene& scene) {
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
}

}  // namespace

void read_tools(const Sections& sections, Scene& scene) {
  for (const SceneSection& section : sections.all("tool", kToolKeys)) {
    const ToolShape tool = read_tool(section);
    const bool couples =
        section.boolean_or(false, "compliance") || !tool.contact.empty();
    // One of several radii is a tool for each of them.
    for (const ToolShape& sphere : spheres_of(tool)) {
      add_tool(section, sphere, scene);
      scene.tool_couples.push_back(couples);
      scene.tool_yielding.push_back(read_yielding(section));
      scene.tool_needle.push_back(section.text("shape") == kNeedle
                                      ? std::optional(read_needle(section))
                                      : std::nullopt);
      scene.tool_mesh.push_back(
          tool.kind == "mesh" ? read_mesh_keys(section, sections.file()) : SceneMesh{});
    }
  }
}

}  // namespace palpate::scene_parts
