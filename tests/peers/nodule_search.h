// Is the nodule found? A blind rule over a raster of presses.
#pragma once

#include <span>
#include <vector>

#include "tests/peers/scene_folder.h"

namespace palpate::peers {

/// A place that is stiffer than those around it.
struct StiffPlace {
  std::size_t place = 0;   ///< of the raster
  double deviation = 0.0;  ///< [-] of its stiffness from the median around it
};

/// The rule: a place's stiffness over the median of those within kAroundSteps steps of
/// the raster, less 1. Places above kNoticed that are the largest within kPeakSteps are
/// finds, the largest first. The rule knows neither the body nor the truth. People tell
/// stiffness apart from about 0.2 on (Jones and Hunter 1990).
constexpr double kNoticed = 0.2;
constexpr double kAroundSteps = 3.5;
constexpr double kPeakSteps = 2.0;
[[nodiscard]] std::vector<StiffPlace> stiff_places(std::span<const PressPlace> raster,
                                                   std::span<const double> force_n);

struct NoduleFind {
  bool found = false;       ///< the first find touches the nodule
  double distance_m = 0.0;  ///< [m] of the first find from it, across the normal; NaN
  double largest_deviation = 0.0;  ///< [-] anywhere on the raster
  int false_finds = 0;             ///< finds that do not touch it
};

/// A press touches the nodule where its axis passes by the nodule's centre within the
/// nodule's radius and the tool's. Without a nodule every find is false.
[[nodiscard]] NoduleFind find_nodule(const PeerScene& scene,
                                     std::span<const double> force_n);

}  // namespace palpate::peers
