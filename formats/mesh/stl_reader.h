// The polygon file formats.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace palpate {

/// Points and faces as a file lists them, in the file's unit, unchecked.
struct PolygonSoup {
  std::vector<Eigen::Vector3d> point;
  std::vector<std::vector<std::size_t>> face;
  std::vector<std::string> note;  ///< what was passed over, or taken for rounding
};

/// Extensions that read_polygon_soup knows.
inline constexpr std::array<std::string_view, 4> kSurfaceExtensions{".obj", ".stl",
                                                                    ".ply", ".off"};

/// Reads the bytes of a file. STL: points that are equal but for rounding become one
/// (weld_points.h); less than one triangle's bytes behind a whole file are passed over.
/// @param extension lower case, with its dot: one of kSurfaceExtensions.
/// @throws FormatError saying what is wrong with the bytes (without a file name).
[[nodiscard]] PolygonSoup read_polygon_soup(std::string bytes,
                                            std::string_view extension);

}  // namespace palpate
