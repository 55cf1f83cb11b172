#include "formats/scene/scene.h"

#include <string_view>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/toml_text.h"
#include "formats/scene/scene_parts.h"

namespace palpate {
namespace {

using scene_parts::kFraction;
using scene_parts::read_inclusions;
using scene_parts::read_materials;
using scene_parts::read_mesh_keys;
using scene_parts::read_supports;
using scene_parts::read_tools;
using scene_parts::SceneFile;
using scene_parts::Sections;

constexpr std::string_view kBodyKeys[] = {"mesh", "length_unit"};
constexpr std::string_view kReachKeys[] = {"box_m", "depth_max_m", "force_max_n"};
constexpr std::string_view kAccuracyKeys[] = {
    "force_relative", "contact_resolution", "depths", "method", "refine",
    "solve",          "solve_depths",       "verify", "bundles"};
constexpr std::string_view kMethods[] = {"auto", "linear", "nonlinear"};
constexpr std::string_view kRefinements[] = {"auto", "global", "local"};
constexpr std::string_view kSolved[] = {"auto", "all"};
constexpr std::string_view kDrawingKeys[] = {"displacement", "error_relative"};

constexpr std::string_view kCutoutKeys[] = {"radius_m", "exterior", "coarse_edge_m"};
constexpr std::string_view kExteriors[] = {"coarse", "clamped"};

constexpr NumberRule kResolution{[](double v) {
                                   return v == 0.0 || (v >= 0.5 && v <= 16.0);
                                 },
                                 "0 or in [0.5, 16]"};

void read_body(const Sections& sections, Scene& scene) {
  const SceneMesh mesh =
      read_mesh_keys(sections.one("body", kBodyKeys), sections.file());
  scene.mesh = mesh.file;
  scene.length_unit = mesh.length_unit;
}

void read_reach(const Sections& sections, Scene& scene) {
  const SceneSection reach = sections.one("reach", kReachKeys);
  if (reach.find("box_m") != nullptr) {
    scene.reach.box_m = reach.box("box_m");
  }
  scene.reach.depth_max_m = reach.number("depth_max_m", kPositive);
  scene.reach.force_max_n =
      reach.number_or(scene.reach.force_max_n, "force_max_n", kPositive);
}

void read_accuracy(const Sections& sections, Scene& scene) {
  if (!sections.has("accuracy")) {
    return;
  }
  const SceneSection accuracy = sections.one("accuracy", kAccuracyKeys);
  scene.force_relative =
      accuracy.number_or(scene.force_relative, "force_relative", kFraction);
  scene.contact_resolution =
      accuracy.number_or(scene.contact_resolution, "contact_resolution", kResolution);
  SceneAccuracy& rest = scene.accuracy;
  rest.depths = accuracy.integer_or(rest.depths, "depths", 2, 64);
  rest.method = accuracy.choice_or(rest.method, "method", kMethods);
  rest.refine = accuracy.choice_or(rest.refine, "refine", kRefinements);
  rest.solve = accuracy.choice_or(rest.solve, "solve", kSolved);
  rest.solve_depths = accuracy.choice_or(rest.solve_depths, "solve_depths", kSolved);
  rest.verify = accuracy.integer_or(rest.verify, "verify", 0, 1000000);
  rest.bundles = accuracy.integer_or(rest.bundles, "bundles", 1, 8);
}

// What sticks moves the body sideways, which linear presses do not.
void refuse_linear_friction(const std::string& file, const Scene& scene) {
  for (const ToolShape& tool : scene.tool) {
    if (tool.sticking && scene.accuracy.method == "linear") {
      throw InputError(
          fmt::format("{}: accuracy.method is \"linear\" and the contact of tool {:?} "
                      "\"sticking\": "
                      "linear presses are \"frictionless\"; take method = \"auto\"",
                      file, tool.name));
    }
  }
}

void read_drawing(const Sections& sections, Scene& scene) {
  if (!sections.has("drawing")) {
    return;
  }
  const SceneSection drawing = sections.one("drawing", kDrawingKeys);
  scene.drawing.displacement =
      drawing.boolean_or(scene.drawing.displacement, "displacement");
  scene.drawing.error_relative =
      drawing.number_or(scene.drawing.error_relative, "error_relative", kFraction);
}

void read_cutout(const Sections& sections, Scene& scene) {
  if (!sections.has("cutout")) {
    return;
  }
  const SceneSection section = sections.one("cutout", kCutoutKeys);
  SceneCutout cutout{.radius_m = section.number("radius_m", kPositive)};
  cutout.exterior = section.choice_or(cutout.exterior, "exterior", kExteriors);
  if (cutout.exterior == "coarse") {
    cutout.coarse_edge_m =
        section.number_or(0.5 * cutout.radius_m, "coarse_edge_m", kPositive);
  } else if (const toml::node* edge = section.find("coarse_edge_m")) {
    section.fail(*edge, "coarse_edge_m belongs to exterior = \"coarse\"");
  }
  if (scene.accuracy.refine == "local") {
    section.fail(
        "[cutout] takes parts of one mesh: accuracy.refine is \"local\", must be "
        "\"auto\" or \"global\"");
  }
  scene.cutout = cutout;
}

}  // namespace

Scene read_scene(const std::filesystem::path& file) {
  Scene scene;
  constexpr std::size_t kSceneBytesMax = 1 << 20;
  scene.text = read_file(file, kSceneBytesMax, "a scene file");
  const std::string name = file.string();
  const toml::table root = parse_toml(scene.text, name);
  const SceneFile scene_file{name, file.parent_path()};
  const Sections sections(scene_file, root);
  read_body(sections, scene);
  read_inclusions(sections, scene);
  read_materials(sections, scene);
  read_supports(sections, scene);
  read_tools(sections, scene);
  read_reach(sections, scene);
  read_accuracy(sections, scene);
  refuse_linear_friction(name, scene);
  read_drawing(sections, scene);
  read_cutout(sections, scene);
  return scene;
}

}  // namespace palpate
