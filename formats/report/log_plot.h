// A plot with two logarithmic axes: cost against accuracy, time against size.
#pragma once

#include <string>
#include <vector>

namespace palpate {

struct LogPoint {
  double x = 0.0;          ///< (0, inf)
  double y = 0.0;          ///< (0, inf)
  double radius_px = 4.0;  ///< [px] of its dot
  std::string label = {};  ///< beside the dot; empty: none
};

struct LogSeries {
  std::string name;
  std::vector<LogPoint> point;
  bool joined = false;  ///< by a line, in the points' order
};

struct LogPicture {
  std::string title;
  std::string subtitle;
  std::string x_name;  ///< with unit: "time [s]"
  std::string y_name;
  std::vector<LogSeries> series;
  double level = 0.0;      ///< a dashed line across at this y; 0: none
  std::string level_name;  ///< at its right end
};

/// A self-contained SVG, 900 x 600 px, wider where a name needs it. Points that are not
/// positive and finite are left out. Equal input gives equal text.
[[nodiscard]] std::string log_picture(const LogPicture& picture);

}  // namespace palpate
