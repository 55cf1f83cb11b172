#include "formats/report/log_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "formats/report/colour_map.h"
#include "formats/report/markup_escape.h"

namespace palpate {
namespace {

constexpr double kLeft = 90.0;
constexpr double kTop = 96.0;
constexpr double kWidth = 560.0;
constexpr double kNames = 38.0;  // from the plot to the names of series
constexpr double kHeight = 430.0;

struct Axis {
  double low = std::numeric_limits<double>::infinity();  // decades
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, std::log10(value));
    high = std::max(high, std::log10(value));
  }
  // Some room around, at least half a decade in all.
  void widen() {
    if (!(low <= high)) {
      low = -0.5;
      high = 0.5;
    }
    const double room = std::max(0.06 * (high - low), 0.25 - 0.5 * (high - low));
    low -= room;
    high += room;
  }
  [[nodiscard]] double place(double value) const {
    return (std::log10(value) - low) / (high - low);
  }
  // Powers of ten; on short axes 2 and 5 times those as well.
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> ticks;
    for (double decade = std::floor(low); decade <= high; ++decade) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double at = decade + std::log10(digit);
        if (at >= low && at <= high && (digit == 1.0 || high - low < 2.5)) {
          ticks.push_back(std::pow(10.0, at));
        }
      }
    }
    return ticks;
  }
};

struct LogAxes {
  Axis horizontal;
  Axis vertical;

  [[nodiscard]] double x(double value) const {
    return kLeft + kWidth * horizontal.place(value);
  }
  [[nodiscard]] double y(double value) const {
    return kTop + kHeight * (1.0 - vertical.place(value));
  }
};

bool can_be_shown(const LogPoint& point) {
  return point.x > 0.0 && point.y > 0.0 && std::isfinite(point.x) &&
         std::isfinite(point.y);
}

std::string tick_text(double value) {
  return value >= 1e-3 && value < 1e5 ? fmt::format("{:.6g}", value)
                                      : fmt::format("{:.0e}", value);
}

LogAxes log_axes_for(const LogPicture& picture) {
  LogAxes axes;
  for (const LogSeries& series : picture.series) {
    for (const LogPoint& point : series.point) {
      if (can_be_shown(point)) {
        axes.horizontal.include(point.x);
        axes.vertical.include(point.y);
      }
    }
  }
  if (picture.level > 0.0) {
    axes.vertical.include(picture.level);
  }
  axes.horizontal.widen();
  axes.vertical.widen();
  return axes;
}

std::string draw_axes(const LogPicture& picture, const LogAxes& axes) {
  std::string svg = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" "
      "stroke=\"#1d2430\"/>\n",
      kLeft, kTop, kWidth, kHeight);
  for (const double tick : axes.horizontal.ticks()) {
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}v{2:.1f}\" stroke=\"#e4e7ec\"/>"
        "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
        axes.x(tick), kTop, kHeight, kTop + kHeight + 20.0, tick_text(tick));
  }
  for (const double tick : axes.vertical.ticks()) {
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h{2:.1f}\" stroke=\"#e4e7ec\"/>"
        "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        kLeft, axes.y(tick), kWidth, kLeft - 9.0, axes.y(tick) + 4.5, tick_text(tick));
  }
  if (picture.level > 0.0) {
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h{2:.1f}\" stroke=\"#5a6473\" "
        "stroke-dasharray=\"6 5\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\" fill=\"#5a6473\">{5}</text>\n",
        kLeft, axes.y(picture.level), kWidth, kLeft + kWidth - 6.0,
        axes.y(picture.level) - 6.0, markup_escaped(picture.level_name));
  }
  return svg + fmt::format(
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n"
                   "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                   kLeft + 0.5 * kWidth, kTop + kHeight + 46.0,
                   markup_escaped(picture.x_name), kLeft - 50.0, kTop - 12.0,
                   markup_escaped(picture.y_name));
}

std::string draw_series(const LogSeries& series, const LogAxes& axes,
                        const std::string& colour) {
  std::string line;
  std::string dots;
  for (const LogPoint& point : series.point) {
    if (!can_be_shown(point)) {
      continue;
    }
    const double x = axes.x(point.x);
    const double y = axes.y(point.y);
    line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", x, y);
    dots += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\" "
        "stroke=\"#ffffff\"/>\n",
        x, y, point.radius_px, colour);
    if (!point.label.empty()) {
      dots +=
          fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11.5\">{}</text>\n",
                      x + point.radius_px + 3.0, y - 4.0, markup_escaped(point.label));
    }
  }
  return series.joined && !line.empty()
             ? fmt::format(
                   "<path d=\"{}\" fill=\"none\" stroke=\"{}\" "
                   "stroke-width=\"1.8\"/>\n",
                   line, colour) +
                   dots
             : dots;
}

// Of the whole picture [px], names beside the plot and all.
double width_of(const LogPicture& picture) {
  constexpr double kCharacter = 7.5;  // of a line of text of 14 px, on the average
  std::size_t longest = 0;
  for (const LogSeries& series : picture.series) {
    longest = std::max(longest, series.name.size());
  }
  return std::max(900.0, std::ceil(kLeft + kWidth + kNames + 20.0 +
                                   kCharacter * static_cast<double>(longest)));
}

}  // namespace

std::string log_picture(const LogPicture& picture) {
  const LogAxes axes = log_axes_for(picture);
  const double width = width_of(picture);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} 600\" "
      "width=\"{0}\" height=\"600\" font-family=\"Helvetica, Arial, sans-serif\" "
      "font-size=\"14\" fill=\"#1d2430\">\n"
      "<rect width=\"{0}\" height=\"600\" rx=\"10\" fill=\"#ffffff\"/>\n"
      "<text x=\"40\" y=\"38\" font-size=\"20\" font-weight=\"600\">{1}</text>\n"
      "<text x=\"40\" y=\"60\" fill=\"#5a6473\">{2}</text>\n",
      width, markup_escaped(picture.title), markup_escaped(picture.subtitle));
  svg += draw_axes(picture, axes);
  const double last =
      static_cast<double>(std::max<std::size_t>(picture.series.size(), 2) - 1);
  for (std::size_t i = 0; i < picture.series.size(); ++i) {
    // The map's light end is hard to see on white.
    const std::string colour = hex(viridis(0.85 * static_cast<double>(i) / last));
    svg += draw_series(picture.series[i], axes, colour);
    const double y = kTop + 16.0 + 26.0 * static_cast<double>(i);
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"{}\"/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
        kLeft + kWidth + 24.0, y, colour, kLeft + kWidth + kNames, y + 4.8,
        markup_escaped(picture.series[i].name));
  }
  return svg.append("</svg>\n");
}

}  // namespace palpate
