#include "formats/measurement/mach1_map.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/column_name.h"

namespace palpate {
namespace {

constexpr const char* kNames[] = {"PixelX", "PixelY", "PointID", "PointType"};

// The line of names among lines; their number where there is none.
std::size_t find_map_names(std::span<const TextLine> lines) {
  const auto has_all = [](const TextLine& line) {
    const auto cells = split_cells(line.text, '\t');
    return std::all_of(std::begin(kNames), std::end(kNames), [&](const char* name) {
      return matching_columns(cells, name).size() == 1;
    });
  };
  return static_cast<std::size_t>(std::find_if(lines.begin(), lines.end(), has_all) -
                                  lines.begin());
}

double number_in(const std::string& file, const TextLine& line,
                 const std::vector<std::string>& cells, std::size_t column,
                 const char* name) {
  const auto value =
      column < cells.size() ? parse_number(cells[column], true) : std::nullopt;
  if (!value || !std::isfinite(*value)) {
    throw FormatError(
        fmt::format("{}: line {}, column \"{}\": \"{}\" is not a finite number", file,
                    line.number, name, column < cells.size() ? cells[column] : ""));
  }
  return *value;
}

}  // namespace

bool is_mach1_map(std::span<const TextLine> lines) {
  return find_map_names(lines) < lines.size();
}

std::vector<MapPoint> read_mach1_map(const std::string& file,
                                     std::span<const TextLine> lines) {
  const std::size_t top = find_map_names(lines);
  const auto names = split_cells(lines[top].text, '\t');
  const auto column = [&](const char* name) {
    const auto found = matching_columns(names, name);
    if (found.size() != 1) {
      throw FormatError(
          fmt::format("{}: line {} names no column \"{}\": a map in pixels alone tells "
                      "no positions",
                      file, lines[top].number, name));
    }
    return found.front();
  };
  const std::size_t id = column("PointID"), type = column("PointType"),
                    x = column("ScanX"), y = column("ScanY");
  // Without a unit in the name: mm, as the software's maps have it.
  const double x_unit = length_unit_si(parse_column_name(names[x]).unit).value_or(1e-3);
  const double y_unit = length_unit_si(parse_column_name(names[y]).unit).value_or(1e-3);
  std::vector<MapPoint> points;
  std::set<int> known;
  for (const TextLine& line : lines.subspan(top + 1)) {
    const auto cells = split_cells(line.text, '\t');
    if (number_in(file, line, cells, type, "PointType") != 0.0) {
      continue;
    }
    MapPoint point;
    const double number = number_in(file, line, cells, id, "PointID");
    if (!(number >= 1.0 && number <= 1e6) || number != std::floor(number) ||
        !known.insert(static_cast<int>(number)).second) {
      throw FormatError(fmt::format(
          "{}: line {}: PointID {} must be a whole number from 1 that comes once", file,
          line.number, number));
    }
    point.id = static_cast<int>(number);
    point.position_m = {x_unit * number_in(file, line, cells, x, "ScanX"),
                        y_unit * number_in(file, line, cells, y, "ScanY")};
    points.push_back(point);
  }
  if (points.empty()) {
    throw FormatError(fmt::format("{}: no row has PointType 0, a point", file));
  }
  return points;
}

}  // namespace palpate
