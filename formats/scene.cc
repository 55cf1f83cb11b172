#include "formats/scene.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/error.h"
#include "formats/scene_section.h"
#include "formats/units.h"

namespace palpate {
namespace {

constexpr std::string_view kSceneKeys[] = {"body", "material", "support",
                                           "tool", "reach",    "accuracy"};
constexpr std::string_view kBodyKeys[] = {"mesh", "length_unit"};
constexpr std::string_view kMaterialKeys[] = {"region", "law", "youngs_modulus_pa",
                                              "poissons_ratio"};
constexpr std::string_view kSupportKeys[] = {"box_m", "kind"};
constexpr std::string_view kToolKeys[] = {"name", "shape", "radius_m", "friction",
                                          "presliding_m"};
constexpr std::string_view kReachKeys[] = {"box_m", "depth_max_m", "force_max_n"};
constexpr std::string_view kAccuracyKeys[] = {"force_relative", "contact_resolution"};
constexpr std::string_view kRegions[] = {"body"};
constexpr std::string_view kLaws[] = {"linear"};
constexpr std::string_view kSupportKinds[] = {"fixed"};
constexpr std::string_view kShapes[] = {"sphere"};

constexpr NumberRule kPositive{[](double v) {
                                 return v > 0.0;
                               },
                               "positive and finite"};
constexpr NumberRule kNotNegative{[](double v) {
                                    return v >= 0.0;
                                  },
                                  "zero or more and finite"};
constexpr NumberRule kPoisson{[](double v) {
                                return v > -1.0 && v < 0.5;
                              },
                              "above -1 and below 0.5"};
constexpr NumberRule kFriction{[](double v) {
                                 return v >= 0.0 && v <= 10.0;
                               },
                               "in [0, 10]"};
constexpr NumberRule kFraction{[](double v) {
                                 return v > 0.0 && v < 1.0;
                               },
                               "above 0 and below 1"};
constexpr NumberRule kResolution{[](double v) {
                                   return v >= 0.5 && v <= 16.0;
                                 },
                                 "in [0.5, 16]"};

// The scene's tables by name: [body], or all of [[material]].
class Sections {
 public:
  Sections(const std::string& file, const toml::table& root)
      : file_(file), root_(file, "the scene", root) {
    if (const toml::node* inclusion = root_.find("inclusion")) {
      root_.fail(*inclusion,
                 "[[inclusion]] is not available yet: a body is of one material; "
                 "available: {}",
                 fmt::join(Names(kSceneKeys), ", "));
    }
    root_.require_known(kSceneKeys);
  }

  [[nodiscard]] bool has(std::string_view key) const {
    return root_.find(key) != nullptr;
  }

  [[nodiscard]] SceneSection one(std::string_view key, Names known) const {
    const toml::node& node = root_.need(key);
    if (!node.is_table()) {
      root_.fail(node, "\"{}\" must be one table: write [{}]", key, key);
    }
    return opened(fmt::format("[{}]", key), *node.as_table(), known);
  }

  [[nodiscard]] std::vector<SceneSection> all(std::string_view key, Names known) const {
    if (!has(key)) {
      throw InputError(
          fmt::format("{}: the scene needs at least one [[{}]]", file_, key));
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
          opened(fmt::format("[[{}]]", key), *element.as_table(), known));
    }
    return sections;
  }

 private:
  [[nodiscard]] SceneSection opened(const std::string& title, const toml::table& table,
                                    Names known) const {
    SceneSection section(file_, title, table);
    section.require_known(known);
    return section;
  }

  const std::string& file_;
  SceneSection root_;
};

void read_body(const Sections& sections, const std::filesystem::path& folder,
               Scene& scene) {
  const SceneSection body = sections.one("body", kBodyKeys);
  scene.mesh = folder / body.text("mesh");
  scene.length_unit = body.text("length_unit");
  try {
    (void)metres_per(scene.length_unit);
  } catch (const InputError& error) {
    body.fail(body.need("length_unit"), "length_unit in [body]: {}", error.what());
  }
}

void read_materials(const Sections& sections, Scene& scene) {
  for (const SceneSection& section : sections.all("material", kMaterialKeys)) {
    SceneMaterial material;
    material.region = section.choice("region", kRegions);
    material.law = section.choice("law", kLaws);
    material.youngs_modulus_pa = section.number("youngs_modulus_pa", kPositive);
    material.poissons_ratio = section.number("poissons_ratio", kPoisson);
    for (const SceneMaterial& other : scene.material) {
      if (other.region == material.region) {
        section.fail("region {:?} has two materials, must have one", material.region);
      }
    }
    scene.material.push_back(material);
  }
}

void read_supports(const Sections& sections, Scene& scene) {
  for (const SceneSection& section : sections.all("support", kSupportKeys)) {
    (void)section.choice("kind", kSupportKinds);
    scene.support.push_back({section.box("box_m")});
  }
}

void read_tools(const Sections& sections, Scene& scene) {
  for (const SceneSection& section : sections.all("tool", kToolKeys)) {
    ToolShape tool;
    tool.name = section.text("name");
    tool.kind = section.choice("shape", kShapes);
    tool.radius_m = section.number("radius_m", kPositive);
    tool.friction = section.number_or(0.0, "friction", kFriction);
    tool.presliding_m = section.number_or(0.0, "presliding_m", kNotNegative);
    for (const ToolShape& other : scene.tool) {
      if (other.name == tool.name) {
        section.fail(section.need("name"), "the name {:?} belongs to two tools",
                     tool.name);
      }
    }
    try {
      check(tool);
    } catch (const InputError& error) {
      section.fail("{}", error.what());
    }
    scene.tool.push_back(tool);
  }
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
}

std::string read_text(const std::filesystem::path& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::string text;
  constexpr std::size_t kLargest = 1 << 20;
  char c = 0;
  while (in.get(c) && text.size() <= kLargest) {
    text += c;
  }
  if (!in && !in.eof()) {
    throw InputError(fmt::format("{}: cannot be read: {}", file.string(),
                                 std::strerror(errno == 0 ? EIO : errno)));
  }
  if (text.size() > kLargest) {
    throw InputError(fmt::format("{}: is larger than {} bytes, must be a scene file",
                                 file.string(), kLargest));
  }
  return text;
}

}  // namespace

Scene read_scene(const std::filesystem::path& file) {
  Scene scene;
  scene.text = read_text(file);
  const std::string name = file.string();
  toml::table root;
  try {
    root = toml::parse(scene.text);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: is not TOML: {}", name,
                                 error.source().begin.line, error.description()));
  }
  const Sections sections(name, root);
  read_body(sections, file.parent_path(), scene);
  read_materials(sections, scene);
  read_supports(sections, scene);
  read_tools(sections, scene);
  read_reach(sections, scene);
  read_accuracy(sections, scene);
  return scene;
}

}  // namespace palpate
