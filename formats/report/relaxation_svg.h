// The plot panel of a relaxation picture: what stays of a force that is held, in SVG.
#pragma once

#include <string>
#include <vector>

#include "formats/report/curves_svg.h"

namespace palpate {

/// G(t) of some nodes in percent over a logarithmic axis of time that holds all of the
/// tool's times, and a legend. SVG elements; `panel` is the plot area inside the axes.
/// @param table whose responses relax.
[[nodiscard]] std::string draw_relaxation(const ResponseTable& table,
                                          const SurfaceMap& map,
                                          const std::vector<ShownCurve>& shown,
                                          const Panel& panel);

}  // namespace palpate
