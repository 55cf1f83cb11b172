// A benchmark's scene, written into its folder (README.md, "A scene's folder").
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "tests/peers/hand_paths.h"

namespace palpate::peers {

/// recipe.txt: where hands go on a body.
struct SceneRecipe {
  Eigen::Vector3d site_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();
  std::optional<Eigen::Vector3d> circle_centre_m;  ///< else the site
  HandRecipe hand;
  double raster_along_m = 0.0;  ///< half of its width; 0: no raster
  double raster_across_m = 0.0;
  double raster_step_m = 0.008;
  double raster_depth_m = 0.004;
  std::optional<Eigen::Vector3d> nodule_m;
  double nodule_radius_m = 0.0;
  double friction = 0.3;  ///< of the variants that have it
  double presliding_m = 0.0005;
  double times_finer = 2.0;  ///< of the truth
};

/// @throws InputError naming the line that is not understood.
[[nodiscard]] SceneRecipe read_recipe(const std::filesystem::path& file);

/// The recipe's places for raster presses, to their depth.
[[nodiscard]] std::vector<PlacedDepth> raster_of(const SurfaceFrame& frame,
                                                 const SceneRecipe& recipe);

/// A hand's tick with its true force on the tool.
struct PlannedTruth {
  std::size_t tick = 0;
  double depth_m = 0.0;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
};

struct ToldHand {
  PlannedHand planned;
  std::vector<PlannedTruth> truth;
  std::vector<PlannedTruth> dense = {};  ///< at the hand's dense ticks
};

/// What a rival reads, but for what only some bodies have.
struct SceneText {
  double tool_radius_m = 0.0;
  PlacedDepth site;
  const SceneRecipe& recipe;
  std::string more;  ///< lines "name value"
};

/// The single stiffness that is least off, in the sum of squares, from the truth over
/// depth: sum F d / sum d^2 [N/m].
[[nodiscard]] double typed_stiffness_n_per_m(const std::vector<ToldHand>& hands);

/// Writes surface.obj, scene.txt, hands/ and truth/.
void write_scene(const std::filesystem::path& folder, const SurfaceMesh& surface,
                 const SceneText& text, const std::vector<ToldHand>& hands);

/// Writes raster.csv. @param force_n along the places' normals; NaN where not known.
void write_raster(const std::filesystem::path& folder,
                  const std::vector<PlacedDepth>& raster,
                  const std::vector<double>& force_n);

}  // namespace palpate::peers
