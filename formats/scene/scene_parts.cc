#include "formats/scene/scene_parts.h"

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/units.h"

namespace palpate::scene_parts {
namespace {

constexpr std::string_view kSceneKeys[] = {"body",    "inclusion", "layer", "material",
                                           "support", "tool",      "reach", "accuracy",
                                           "drawing", "cutout"};
constexpr std::string_view kBallKeys[] = {"center_m", "radius_m"};

SceneSection opened(const SceneFile& file, const std::string& title,
                    const toml::table& table, Names known) {
  SceneSection section(file.name, title, table);
  section.require_known(known);
  return section;
}

}  // namespace

Sections::Sections(const SceneFile& file, const toml::table& root)
    : file_(file), root_(file.name, "the scene", root) {
  root_.require_known(kSceneKeys);
}

bool Sections::has(std::string_view key) const {
  return root_.find(key) != nullptr;
}

SceneSection Sections::one(std::string_view key, Names known) const {
  const toml::node& node = root_.need(key);
  if (!node.is_table()) {
    root_.fail(node, "\"{}\" must be one table: write [{}]", key, key);
  }
  return opened(file_, fmt::format("[{}]", key), *node.as_table(), known);
}

std::vector<SceneSection> Sections::all(std::string_view key, Names known) const {
  if (!has(key)) {
    throw InputError(
        fmt::format("{}: the scene needs at least one [[{}]]", file_.name, key));
  }
  const toml::node& node = root_.need(key);
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty() ||
      !array->is_homogeneous(toml::node_type::table)) {
    root_.fail(node, "\"{}\" must be a list of tables: write [[{}]]", key, key);
  }
  std::vector<SceneSection> sections;
  for (const toml::node& element : *array) {
    sections.push_back(
        opened(file_, fmt::format("[[{}]]", key), *element.as_table(), known));
  }
  return sections;
}

SceneMesh read_mesh_keys(const SceneSection& section, const SceneFile& file) {
  SceneMesh mesh{file.folder / section.text("mesh"), section.text("length_unit")};
  try {
    (void)metres_per(mesh.length_unit);
  } catch (const InputError& error) {
    section.fail(section.need("length_unit"), "length_unit in {}: {}", section.title(),
                 error.what());
  }
  return mesh;
}

SceneBall read_ball(const SceneSection& section, std::string_view key) {
  const SceneSection ball = section.table(key, kBallKeys);
  return {ball.vector("center_m"), ball.number("radius_m", kPositive)};
}

}  // namespace palpate::scene_parts
