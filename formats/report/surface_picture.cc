#include "formats/report/surface_picture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/database_summary.h"
#include "formats/report/axis_ticks.h"
#include "formats/report/body_svg.h"
#include "formats/report/colour_map.h"
#include "formats/report/curves_svg.h"
#include "formats/report/markup_escape.h"
#include "formats/report/relaxation_svg.h"
#include "formats/report/surface_map.h"

namespace palpate {
namespace {

constexpr Panel kBody{40.0, 92.0, 500.0, 430.0};
constexpr Panel kBar{592.0, 150.0, 16.0, 300.0};
constexpr Panel kPlot{770.0, 128.0, 390.0, 390.0};

bool shows_relaxation(Shown shown) {
  return shown == Shown::kRelaxation || shown == Shown::kTime;
}

// Names come in any length; the title has room for so much.
std::string shortened(const std::string& name) {
  constexpr std::size_t kRoom = 40;
  return name.size() <= kRoom ? name : fmt::format("{:.{}}...", name, kRoom - 3);
}

std::string draw_title(const ResponseDatabase& database, const ResponseTable& table,
                       const SurfaceMap& map, Shown shown) {
  const std::string body =
      database.provenance.source_file.empty()
          ? "A body"
          : markup_escaped(shortened(database.provenance.source_file));
  const std::int64_t over = summarise(table).error_over_budget;
  const std::string doubts =
      over == 0 ? "" : fmt::format("; {} are outside the error budget", over);
  return fmt::format(
      "<text x=\"40\" y=\"44\" font-size=\"20\" font-weight=\"600\">{} under \"{}\", a "
      "{} of radius {} mm</text>\n"
      "<text x=\"40\" y=\"68\" fill=\"#5a6473\">{} of {} nodes have a response, the "
      "others are grey{}</text>\n"
      "<text x=\"{}\" y=\"68\" fill=\"#5a6473\">{} of the numbered nodes</text>\n",
      body, markup_escaped(table.tool.name), markup_escaped(table.tool.kind),
      short_number(1e3 * table.tool.radius_m), map.lowest_first.size(), table.nodes(),
      doubts, kPlot.x - 30.0,
      !shows_relaxation(shown) ? "responses" : "force that stays while held");
}

// A soft shadow on the ground beneath the body, seen at the camera's angle.
std::string draw_shadow(const SurfaceMesh& body, const View& view) {
  const Eigen::AlignedBox3d box = bounding_box(body);
  Eigen::Vector3d ground = box.center();
  ground.z() = box.min().z();
  const Eigen::Vector2d at = view.at(ground);
  const Eigen::Vector3d half = 0.5 * box.sizes();
  const double across =
      std::hypot(view.axes(0, 0) * half.x(), view.axes(0, 1) * half.y());
  const double along =
      std::hypot(view.axes(1, 0) * half.x(), view.axes(1, 1) * half.y());
  return fmt::format(
      "<ellipse cx=\"{:.1f}\" cy=\"{:.1f}\" rx=\"{:.1f}\" ry=\"{:.1f}\" "
      "fill=\"url(#shadow)\"/>\n",
      at.x(), at.y(), 1.12 * view.px_per_m * across, 1.12 * view.px_per_m * along);
}

std::string draw_scale_bar(const View& view) {
  const double length_m = round_down(0.3 * kBody.width / view.px_per_m);
  const double px = length_m * view.px_per_m;
  const double y = 560.0;
  return fmt::format(
      "<path d=\"M{0:.1f} {1:.1f}v8m0 -4h{2:.1f}m0 -4v8\" stroke=\"#1d2430\" "
      "stroke-width=\"1.6\" fill=\"none\"/>"
      "<text x=\"{3:.1f}\" y=\"{4:.1f}\">{5} mm</text>\n",
      kBody.x, y, px, kBody.x + px + 10.0, y + 8.5, short_number(1e3 * length_m));
}

std::string draw_colour_bar(const SurfaceMap& map) {
  const double bottom = kBar.y + kBar.height;
  std::string svg = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"url(#viridis)\"/>\n",
      kBar.x, kBar.y, kBar.width, kBar.height);
  // Pointed ends: stiffer or softer nodes exist and have the colour of the end.
  if (map.clipped_high) {
    svg += fmt::format("<path d=\"M{} {}h{}l{} -13z\" fill=\"{}\"/>\n", kBar.x,
                       kBar.y - 1.0, kBar.width, -kBar.width / 2.0, hex(viridis(1.0)));
  }
  if (map.clipped_low) {
    svg += fmt::format("<path d=\"M{} {}h{}l{} 13z\" fill=\"{}\"/>\n", kBar.x,
                       bottom + 1.0, kBar.width, -kBar.width / 2.0, hex(viridis(0.0)));
  }
  for (const double tick : axis_ticks(map.low, map.high, 6)) {
    const double y = bottom - kBar.height * map.place(tick);
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h5\" stroke=\"#1d2430\"/>"
        "<text x=\"{2:.1f}\" y=\"{3:.1f}\">{4}</text>\n",
        kBar.x + kBar.width, y, kBar.x + kBar.width + 10.0, y + 4.5,
        short_number(tick));
  }
  return svg + fmt::format(
                   "<text x=\"{0}\" y=\"{1}\">{3}</text>"
                   "<text x=\"{0}\" y=\"{2}\" fill=\"#5a6473\">{4}</text>\n",
                   kBar.x, kBar.y - 42.0, kBar.y - 24.0, map.name, map.note);
}

std::string definitions() {
  std::string svg =
      "<defs>\n<radialGradient id=\"shadow\"><stop offset=\"0.45\" "
      "stop-color=\"#1d2430\" stop-opacity=\"0.22\"/><stop offset=\"1\" "
      "stop-color=\"#1d2430\" stop-opacity=\"0\"/></radialGradient>\n"
      "<linearGradient id=\"viridis\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">\n";
  for (int i = 0; i <= 10; ++i) {
    svg += fmt::format("<stop offset=\"{:.1f}\" stop-color=\"{}\"/>", 0.1 * i,
                       hex(viridis(0.1 * i)));
  }
  return svg.append("\n</linearGradient>\n</defs>\n");
}

SurfaceMap map_of(const ResponseTable& table, Shown what) {
  if (what == Shown::kStiffness) {
    return stiffness_map(table);
  }
  if (!shows_relaxation(what)) {
    const Yielding& yielding = table.viscoelasticity.yielding;
    const bool dents = what == Shown::kDents;
    if ((dents ? yielding.share : yielding.largest).empty()) {
      throw InputError(
          fmt::format("the responses of tool {:?} {}: there is nothing to show",
                      table.tool.name, dents ? "leave no dents" : "do not soften"));
    }
    return dents ? dent_map(table) : softening_map(table);
  }
  if (table.viscoelasticity.empty()) {
    throw InputError(fmt::format(
        "the responses of tool {:?} are static: there is no relaxation to show",
        table.tool.name));
  }
  return what == Shown::kRelaxation ? relaxation_map(table)
                                    : relaxation_time_map(table);
}

}  // namespace

std::string surface_picture(const ResponseDatabase& database,
                            const ResponseTable& table, Shown what) {
  const SurfaceMap map = map_of(table, what);
  const View view = choose_view(database.body, map, kBody);
  const std::vector<ShownCurve> shown = choose_curves(map, database.normal, view);
  std::vector<std::int64_t> nodes;
  nodes.reserve(shown.size());
  for (const ShownCurve& curve : shown) {
    nodes.push_back(curve.node);
  }
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1200 600\" "
      "width=\"1200\" height=\"600\" font-family=\"Helvetica, Arial, sans-serif\" "
      "font-size=\"14\" fill=\"#1d2430\">\n";
  svg += definitions();
  svg += "<rect width=\"1200\" height=\"600\" rx=\"10\" fill=\"#ffffff\"/>\n";
  svg += draw_title(database, table, map, what);
  svg += draw_shadow(database.body, view);
  svg += draw_body(database.body, database.normal, map, view);
  svg += draw_marks(database.body, database.normal, nodes, view);
  svg += draw_scale_bar(view);
  if (!shown.empty()) {
    svg += draw_colour_bar(map);
    svg += !shows_relaxation(what) ? draw_curves(table, map, shown, kPlot)
                                   : draw_relaxation(table, map, shown, kPlot);
  }
  return svg.append("</svg>\n");
}

}  // namespace palpate
