#include "formats/report/curves_svg.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/report/axis_ticks.h"
#include "formats/report/colour_map.h"

namespace palpate {
namespace {

// From millimetres and newtons to the panel.
struct CurveAxes {
  Panel panel;
  double depth_max_mm;
  double force_max_n;

  [[nodiscard]] double x(double depth_mm) const {
    return panel.x + panel.width * depth_mm / depth_max_mm;
  }
  [[nodiscard]] double y(double force_n) const {
    return panel.y + panel.height * (1.0 - force_n / force_max_n);
  }
};

CurveAxes axes_for(const ResponseTable& table, const std::vector<ShownCurve>& shown,
                   const Panel& panel) {
  CurveAxes axes{panel, 0.0, 0.0};
  for (const ShownCurve& curve : shown) {
    const CurveView view = table.curve(curve.node);
    axes.depth_max_mm = std::max(axes.depth_max_mm, 1e3 * view.depth_max_m());
    axes.force_max_n = std::max(
        axes.force_max_n, *std::max_element(view.force_n.begin(), view.force_n.end()));
  }
  // Room above the curves for the legend.
  axes.depth_max_mm = axes.depth_max_mm > 0.0 ? 1.02 * axes.depth_max_mm : 1.0;
  axes.force_max_n = axes.force_max_n > 0.0 ? 1.28 * axes.force_max_n : 1.0;
  return axes;
}

std::string draw_grid(const CurveAxes& axes) {
  const Panel& panel = axes.panel;
  const double bottom = panel.y + panel.height;
  std::string svg;
  for (const double force : axis_ticks(0.0, axes.force_max_n, 5)) {
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h{2:.1f}\" stroke=\"#e4e7ec\"/>"
        "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        panel.x, axes.y(force), panel.width, panel.x - 9.0, axes.y(force) + 4.5,
        short_number(force));
  }
  for (const double depth : axis_ticks(0.0, axes.depth_max_mm, 6)) {
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}v5\" stroke=\"#1d2430\"/>"
        "<text x=\"{0:.1f}\" y=\"{2:.1f}\" text-anchor=\"middle\">{3}</text>\n",
        axes.x(depth), bottom, bottom + 20.0, short_number(depth));
  }
  return svg + fmt::format(
                   "<path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"#1d2430\"/>"
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">"
                   "displacement along the force [mm]</text>"
                   "<text x=\"{:.1f}\" y=\"{:.1f}\">force [N]</text>\n",
                   panel.x, bottom, panel.width, panel.x + panel.width / 2.0,
                   bottom + 42.0, panel.x - 30.0, panel.y - 12.0);
}

// A Hermite cubic over an interval of width h is the Bezier curve whose inner control
// points lie h/3 inside, on the tangents: the picture shows the stored curve itself.
std::string bezier_path(const CurveAxes& axes, const CurveView& curve) {
  const auto point = [&](double depth_m, double force_n) {
    return fmt::format("{:.2f} {:.2f}", axes.x(1e3 * depth_m), axes.y(force_n));
  };
  std::string path = "M" + point(0.0, 0.0);
  for (std::size_t i = 0; i + 1 < curve.depth_m.size(); ++i) {
    const double third = (curve.depth_m[i + 1] - curve.depth_m[i]) / 3.0;
    path += "C" +
            point(curve.depth_m[i] + third,
                  curve.force_n[i] + third * curve.stiffness_n_per_m[i]) +
            " " +
            point(curve.depth_m[i + 1] - third,
                  curve.force_n[i + 1] - third * curve.stiffness_n_per_m[i + 1]) +
            " " + point(curve.depth_m[i + 1], curve.force_n[i + 1]);
  }
  return path;
}

std::string draw_curve(const CurveAxes& axes, const CurveView& curve,
                       const std::string& colour) {
  std::string svg = draw_line(bezier_path(axes, curve), colour);
  for (std::size_t i = 1; i < curve.depth_m.size(); ++i) {
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"#ffffff\" stroke=\"{}\" "
        "stroke-width=\"1.8\"/>",
        axes.x(1e3 * curve.depth_m[i]), axes.y(curve.force_n[i]), colour);
  }
  return svg + "\n";
}

std::string draw_legend_entry(double x, double y, std::size_t number,
                              const std::string& text, const std::string& colour) {
  return fmt::format(
      "<path d=\"M{0:.1f} {1:.1f}h24\" stroke=\"#1d2430\" stroke-opacity=\"0.35\" "
      "stroke-width=\"4.2\"/><path d=\"M{0:.1f} {1:.1f}h24\" stroke=\"{2}\" "
      "stroke-width=\"2.8\"/>"
      "<circle cx=\"{3:.1f}\" cy=\"{1:.1f}\" r=\"8.5\" fill=\"#ffffff\" "
      "stroke=\"#1d2430\" stroke-width=\"1.4\"/>"
      "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"middle\" font-size=\"11.5\" "
      "font-weight=\"600\">{5}</text><text x=\"{6:.1f}\" y=\"{7:.1f}\">{8}</text>\n",
      x, y, colour, x + 40.0, y + 4.1, number, x + 57.0, y + 4.8, text);
}

}  // namespace

std::vector<ShownCurve> choose_curves(const SurfaceMap& map, const Points& normal,
                                      const View& view) {
  struct Rank {
    double part;
    const char* label;
    double slack;
  };
  constexpr Rank kRanks[] = {{0.0, "lowest", 0.0},
                             {0.25, "quarter", 0.04},
                             {0.5, "median", 0.04},
                             {0.75, "three quarters", 0.04},
                             {1.0, "highest", 0.0}};
  const std::vector<std::int64_t>& order = map.lowest_first;
  const auto is_seen = [&](std::int64_t node) {
    return faces_viewer(view, normal.row(node).transpose());
  };
  std::vector<ShownCurve> shown;
  for (const Rank& rank : kRanks) {
    if (order.empty()) {
      break;
    }
    const double last = static_cast<double>(order.size() - 1);
    const auto at = std::lround(rank.part * last);
    std::int64_t node = order[static_cast<std::size_t>(at)];
    // The node of the rank, or the nearest in rank that the picture shows, within the
    // slack.
    for (long off = 0; off <= std::lround(rank.slack * last) && !is_seen(node); ++off) {
      for (const long i : {at - off, at + off}) {
        const std::int64_t other = order[static_cast<std::size_t>(i)];
        node = is_seen(other) ? other : node;
      }
    }
    if (shown.empty() || shown.back().node != node) {
      shown.push_back({node, rank.label, !is_seen(node)});
    }
  }
  return shown;
}

std::string draw_line(const std::string& path, const std::string& colour) {
  return fmt::format(
      "<path d=\"{0}\" fill=\"none\" stroke=\"#1d2430\" stroke-opacity=\"0.35\" "
      "stroke-width=\"4.2\" stroke-linecap=\"round\"/>"
      "<path d=\"{0}\" fill=\"none\" stroke=\"{1}\" stroke-width=\"2.8\" "
      "stroke-linecap=\"round\"/>\n",
      path, colour);
}

std::string draw_legend(const SurfaceMap& map, const std::vector<ShownCurve>& shown,
                        const Panel& panel) {
  std::string legend;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double value = map.value[static_cast<std::size_t>(shown[i].node)];
    const std::size_t row = shown.size() - 1 - i;
    legend += draw_legend_entry(
        panel.x + 16.0, panel.y + 14.0 + 24.0 * static_cast<double>(row), i + 1,
        fmt::format("{}: {} {} (node {}{})", shown[i].label, short_number(value),
                    map.unit, shown[i].node, shown[i].hidden ? ", behind" : ""),
        hex(viridis(map.place(value))));
  }
  return legend;
}

std::string draw_curves(const ResponseTable& table, const SurfaceMap& map,
                        const std::vector<ShownCurve>& shown, const Panel& panel) {
  const CurveAxes axes = axes_for(table, shown, panel);
  std::string svg = draw_grid(axes);
  for (const ShownCurve& curve : shown) {
    const double value = map.value[static_cast<std::size_t>(curve.node)];
    svg += draw_curve(axes, table.curve(curve.node), hex(viridis(map.place(value))));
  }
  return svg + draw_legend(map, shown, panel);
}

}  // namespace palpate
