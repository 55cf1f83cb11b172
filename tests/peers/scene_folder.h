// A benchmark's scene, as it lies in its folder (README.md, "A scene's folder").
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate::peers {

constexpr double kHandTickS = 0.001;  ///< [s] between poses of a recorded hand

/// A tick of a hand and the force that the body truly answers with.
struct TruePoint {
  std::int64_t tick = 0;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< on the tool
};

struct Hand {
  std::string name;
  std::vector<Eigen::Vector3d> centre_m;  ///< of the ball, one each kHandTickS
  std::vector<Eigen::Vector3d> outward;   ///< unit, the body's where the ball is
  std::vector<TruePoint> truth;           ///< ascending ticks; may be empty
  std::vector<TruePoint> dense_truth;     ///< likewise, of a way along the surface
};

/// A place that is pressed, along its normal.
struct PressPlace {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();      ///< on the surface
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  ///< unit normal
  double true_force_n = 0.0;  ///< along it at the press' depth; NaN: not known
};

/// [m] of the ball that has reached the place, a depth further in.
[[nodiscard]] inline Eigen::Vector3d centre_at(const PressPlace& place, double radius_m,
                                               double depth_m) {
  return place.at_m + (radius_m - depth_m) * place.outward;
}

struct PeerScene {
  std::filesystem::path folder;
  std::string name;
  double radius_m = 0.0;     ///< of the tool, a ball
  double depth_max_m = 0.0;  ///< of presses
  PressPlace site;           ///< where a device leans on the body
  SurfaceMesh surface;
  std::vector<Hand> hand;          ///< by name
  std::vector<PressPlace> raster;  ///< presses that look for the nodule; may be empty
  double raster_depth_m = 0.0;
  std::optional<Eigen::Vector3d> nodule_m;  ///< its centre, where there is one
  double nodule_radius_m = 0.0;
  std::map<std::string, std::string> value;  ///< every line of scene.txt

  [[nodiscard]] const Hand* find(const std::string& hand_name) const;
};

/// @throws InputError for what is missing, FormatError for what cannot be read: file,
/// line, what would be right.
[[nodiscard]] PeerScene read_peer_scene(const std::filesystem::path& folder);

/// Rows of numbers below a header, separated by commas.
[[nodiscard]] std::vector<std::vector<double>> read_table(
    const std::filesystem::path& file, std::size_t columns);

}  // namespace palpate::peers
