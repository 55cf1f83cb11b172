// The plot panel of a stiffness picture: a few force-depth curves in SVG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/report/body_svg.h"
#include "formats/report/surface_map.h"

namespace palpate {

/// A node whose curve is shown, and why.
struct ShownCurve {
  std::int64_t node = -1;
  std::string label;    ///< "lowest"
  bool hidden = false;  ///< turned away from the viewer
};

/// Nodes of the lowest, median and highest value and the quartiles between them. The
/// inner ones are nodes turned to the viewer, where such a node is within 4 % of the
/// rank. The nodes are fewer if the table has fewer responses.
[[nodiscard]] std::vector<ShownCurve> choose_curves(const SurfaceMap& map,
                                                    const Points& normal,
                                                    const View& view);

/// Axes in mm and N, the curves drawn as the cubics they are with their samples, and a
/// legend. SVG elements; `panel` is the plot area inside the axes.
[[nodiscard]] std::string draw_curves(const ResponseTable& table, const SurfaceMap& map,
                                      const std::vector<ShownCurve>& shown,
                                      const Panel& panel);

/// A row for each node in the upper left of a panel: colour, number, label, value and
/// node; the last of them on top. SVG elements.
[[nodiscard]] std::string draw_legend(const SurfaceMap& map,
                                      const std::vector<ShownCurve>& shown,
                                      const Panel& panel);

/// A curve over a darker line, so that the light end of the colours is readable.
/// @param path of SVG. SVG elements.
[[nodiscard]] std::string draw_line(const std::string& path, const std::string& colour);

}  // namespace palpate
