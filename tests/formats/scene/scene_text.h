// A scene that is right, and what is said of scenes that are not.
#pragma once

#include <cstddef>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/scene/scene.h"
#include "tests/support/test_data.h"

namespace palpate {

// Line numbers in tests count from this text's first line.
inline constexpr const char* kScene = R"([body]
mesh = "liver.obj"
length_unit = "cm"

[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.45

[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1, -0.0199]]
kind = "fixed"

[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.005
friction = 0.3
presliding_m = 0.0005

[reach]
box_m = [[-1.0, -1.0, -0.001], [1.0, 1.0, 1.0]]
depth_max_m = 0.005
force_max_n = 8.0

[accuracy]
force_relative = 0.04
contact_resolution = 3
)";

// Its material and its tool, as scene_with() finds them.
inline constexpr const char* kIsotropic =
    "law = \"linear\"\nyoungs_modulus_pa = 5000.0\npoissons_ratio = 0.45\n";
inline constexpr const char* kSphere = "shape = \"sphere\"\nradius_m = 0.005\n";

inline Scene read_scene_text(const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder / "scene.toml") << text;
  return read_scene(folder / "scene.toml");
}

// The scene with the first occurrence of `from` replaced.
inline std::string scene_with(const std::string& from, const std::string& to) {
  std::string text = kScene;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// The material of the scene under another law.
inline SceneMaterial material_of(const std::string& law) {
  const Scene scene = read_scene_text(scene_with(kIsotropic, law));
  EXPECT_EQ(scene.material.size(), 1u);
  return scene.material.at(0);
}

inline std::string error_of(const std::string& text) {
  try {
    (void)read_scene_text(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A scene that is wrong in one place.
struct Mistake {
  const char* from;
  const char* to;
  const char* message;  ///< what the error says after the scene file's path
};

inline void expect_named(const Mistake& mistake) {
  const std::string error = error_of(scene_with(mistake.from, mistake.to));
  EXPECT_NE(error.find(std::string("scene.toml") + mistake.message), std::string::npos)
      << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

using SceneMistakeTest = testing::TestWithParam<Mistake>;

}  // namespace palpate
