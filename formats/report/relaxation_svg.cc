#include "formats/report/relaxation_svg.h"

#include <cmath>

#include <fmt/format.h>

#include "formats/report/axis_ticks.h"
#include "formats/report/colour_map.h"

namespace palpate {
namespace {

// From seconds, by their logarithm, and percent to the panel.
struct RelaxationAxes {
  Panel panel;
  double log_first;  // of 10, of the first second shown
  double log_last;

  [[nodiscard]] double x(double log_time) const {
    return panel.x + panel.width * (log_time - log_first) / (log_last - log_first);
  }
  // Room above the curves for the legend.
  [[nodiscard]] double y(double percent) const {
    return panel.y + panel.height * (1.0 - percent / 155.0);
  }
};

std::string draw_time_grid(const RelaxationAxes& axes) {
  const Panel& panel = axes.panel;
  const double bottom = panel.y + panel.height;
  std::string svg;
  for (int percent = 0; percent <= 100; percent += 20) {
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h{2:.1f}\" stroke=\"#e4e7ec\"/>"
        "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        panel.x, axes.y(percent), panel.width, panel.x - 9.0, axes.y(percent) + 4.5,
        percent);
  }
  for (int power = static_cast<int>(std::ceil(axes.log_first)); power <= axes.log_last;
       ++power) {
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}v5\" stroke=\"#1d2430\"/>"
        "<text x=\"{0:.1f}\" y=\"{2:.1f}\" text-anchor=\"middle\">{3}</text>\n",
        axes.x(power), bottom, bottom + 20.0, short_number(std::pow(10.0, power)));
  }
  return svg + fmt::format(
                   "<path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"#1d2430\"/>"
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">"
                   "time since the press [s]</text>"
                   "<text x=\"{:.1f}\" y=\"{:.1f}\">force [%]</text>\n",
                   panel.x, bottom, panel.width, panel.x + panel.width / 2.0,
                   bottom + 42.0, panel.x - 30.0, panel.y - 12.0);
}

std::string path_of(const RelaxationAxes& axes, const Viscoelasticity& relaxation,
                    std::int64_t node) {
  constexpr int kPoints = 120;
  std::string path;
  for (int i = 0; i <= kPoints; ++i) {
    const double log_time =
        axes.log_first + (axes.log_last - axes.log_first) * i / kPoints;
    const double share = relaxed_share(relaxation, node, std::pow(10.0, log_time));
    path += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M" : "L", axes.x(log_time),
                        axes.y(100.0 * share));
  }
  return path;
}

}  // namespace

std::string draw_relaxation(const ResponseTable& table, const SurfaceMap& map,
                            const std::vector<ShownCurve>& shown, const Panel& panel) {
  const Viscoelasticity& relaxation = table.viscoelasticity;
  const RelaxationAxes axes{panel,
                            std::floor(std::log10(0.03 * relaxation.tau_s.front())),
                            std::ceil(std::log10(5.0 * relaxation.tau_s.back()))};
  std::string svg = draw_time_grid(axes);
  for (const ShownCurve& curve : shown) {
    const double value = map.value[static_cast<std::size_t>(curve.node)];
    svg += draw_line(path_of(axes, relaxation, curve.node),
                     hex(viridis(map.place(value))));
  }
  return svg + draw_legend(map, shown, panel);
}

}  // namespace palpate
