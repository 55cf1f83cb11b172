// Table of points that goes with the presses of a Biomomentum Mach-1 mapping (".map").
// Six lines of information come first, the same in every column. A line of names
// follows: PixelX PixelY PointID PointType Sub-SurfaceID [ScanX(mm) ScanY(mm)] ... Then
// come rows between tabs. PointType 0 is a point that was pressed, 1 of a border, 2 a
// reference.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/measurement/delimited_text.h"

namespace palpate {

struct MapPoint {
  int id = 0;                                            ///< PointID, from 1
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< (2) [m] ScanX, ScanY
};

[[nodiscard]] bool is_mach1_map(std::span<const TextLine> lines);

/// The points that were pressed, in the file's order.
/// @throws FormatError naming line and column of a bad cell, and for an id that comes
/// twice. FormatError too for a map in pixels alone, whose scale nobody knows.
[[nodiscard]] std::vector<MapPoint> read_mach1_map(const std::string& file,
                                                   std::span<const TextLine> lines);

}  // namespace palpate
