// The parts of a scene file, each read by a source of its own. Only for scene*.cc.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/scene/scene.h"
#include "formats/scene/toml_section.h"

namespace palpate::scene_parts {

/// What a part needs to know besides its own tables.
struct SceneFile {
  std::string name;              ///< for messages
  std::filesystem::path folder;  ///< relative paths start here
};

/// The scene's tables by name: [body], or all of [[material]].
class Sections {
 public:
  /// @throws InputError for a table that is not known.
  Sections(const SceneFile& file, const toml::table& root);

  [[nodiscard]] const SceneFile& file() const { return file_; }
  [[nodiscard]] bool has(std::string_view key) const;

  /// [key]. @throws InputError if it is missing, a list, or has an unknown key.
  [[nodiscard]] SceneSection one(std::string_view key, Names known) const;

  /// All of [[key]], at least one.
  [[nodiscard]] std::vector<SceneSection> all(std::string_view key, Names known) const;

 private:
  const SceneFile& file_;
  SceneSection root_;
};

void read_inclusions(const Sections& sections, Scene& scene);
void read_materials(const Sections& sections, Scene& scene);
void read_supports(const Sections& sections, Scene& scene);
void read_tools(const Sections& sections, Scene& scene);

/// The keys mesh and length_unit of a section.
[[nodiscard]] SceneMesh read_mesh_keys(const SceneSection& section,
                                       const SceneFile& file);

/// The keys plastic and damage of a section.
[[nodiscard]] SceneYielding read_yielding(const SceneSection& section);

/// The key puncture of a material; none without it.
[[nodiscard]] std::optional<ScenePuncture> read_puncture(const SceneSection& section);

/// A tool of shape "needle".
[[nodiscard]] SceneNeedle read_needle(const SceneSection& section);

/// { center_m = [x, y, z], radius_m = r }
[[nodiscard]] SceneBall read_ball(const SceneSection& section, std::string_view key);

inline constexpr NumberRule kPoisson{[](double v) {
                                       return v > -1.0 && v < 0.5;
                                     },
                                     "above -1 and below 0.5"};
inline constexpr NumberRule kFraction{[](double v) {
                                        return v > 0.0 && v < 1.0;
                                      },
                                      "above 0 and below 1"};
inline constexpr NumberRule kBelowOne{[](double v) {
                                        return v >= 0.0 && v < 1.0;
                                      },
                                      "in [0, 1)"};
inline constexpr NumberRule kAny{[](double) {
                                   return true;
                                 },
                                 "finite"};

}  // namespace palpate::scene_parts
