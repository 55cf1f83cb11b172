// A scene: the body, what it is made of, where it is held, who presses it and how far.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/tool_shape.h"

namespace palpate {

struct SceneMaterial {
  std::string region = "body";
  std::string law = "linear";      ///< the one law there is so far
  double youngs_modulus_pa = 0.0;  ///< [Pa] (0, inf)
  double poissons_ratio = 0.0;     ///< [-] (-1, 0.5)
};

struct SceneSupport {
  Eigen::AlignedBox3d box_m;  ///< [m] surface vertices inside are held
};

struct SceneReach {
  std::optional<Eigen::AlignedBox3d> box_m;  ///< [m]; none: every unsupported vertex
  double depth_max_m = 0.0;  ///< [m] (0, inf) largest normal penetration
  /// [N] (0, inf] curves end where they pass it; inf where the scene gives none.
  double force_max_n = std::numeric_limits<double>::infinity();
};

struct Scene {
  std::filesystem::path mesh;  ///< absolute, or relative to the working directory
  std::string length_unit;     ///< of the mesh file, known to metres_per
  std::vector<SceneMaterial> material;
  std::vector<SceneSupport> support;
  std::vector<ToolShape> tool;
  SceneReach reach;
  double force_relative = 0.05;  ///< [-] (0, 1) accuracy budget: relative force error
  /// [-] [0.5, 16] element sizes that the contact radius spans at the largest depth.
  double contact_resolution = 2.0;
  std::string text;  ///< the file as read, for provenance
};

/// Reads and checks a scene file (TOML). A relative mesh path is taken from the scene
/// file's folder. @throws InputError "scene.toml:12: ..." naming the key, its value and
/// what is allowed; for an unknown key, the nearest known one.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file);

}  // namespace palpate
