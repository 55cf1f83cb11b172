#include "formats/measurement/optics11_file.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"
#include "formats/measurement/text_table.h"

namespace palpate {
namespace {

// The line of column names among lines; their number where there is none.
std::size_t find_names(std::span<const TextLine> lines) {
  std::size_t at = 0;
  for (; at < lines.size(); ++at) {
    const auto cells = split_cells(lines[at].text, '\t');
    const auto has = [&](const char* name) {
      return matching_columns(cells, name).size() == 1;
    };
    if (has("Load") && has("Indentation") && has("Cantilever") && has("Piezo")) {
      break;
    }
  }
  return at;
}

// Values of the head by the name without its unit, in SI units.
std::map<std::string, double> head_values(std::span<const TextLine> head) {
  std::map<std::string, double> values;
  for (const TextLine& line : head) {
    const auto cells = split_cells(line.text, '\t');
    const auto number = cells.size() > 1 ? parse_number(cells[1], true) : std::nullopt;
    if (!number || !std::isfinite(*number)) {
      continue;
    }
    const ColumnName name = parse_column_name(cells[0]);
    values[name.quantity] = *number * length_unit_si(name.unit).value_or(1.0);
  }
  return values;
}

std::vector<TextLine> table_lines(const std::filesystem::path& file,
                                  InstrumentCurve& curve) {
  std::vector<TextLine> lines = read_text_lines(file);
  const std::size_t names = find_names(lines);
  if (names == lines.size()) {
    throw FormatError(fmt::format(
        "{}: no line names the columns Load, Indentation, Cantilever and Piezo",
        file.string()));
  }
  const auto head = head_values(std::span(lines).first(names));
  const auto value = [&](const char* name) {
    const auto found = head.find(name);
    return found == head.end() ? std::nullopt : std::optional(found->second);
  };
  if (const auto radius = value("Tip radius"); radius && *radius > 0.0) {
    curve.tip_radius_m = radius;
  }
  if (const auto spring = value("k"); spring && *spring > 0.0) {
    curve.spring_n_per_m = spring;
  }
  if (value("X-position") && value("Y-position")) {
    curve.position_m = Eigen::Vector3d(*value("X-position"), *value("Y-position"), 0.0);
  }
  curve.line = lines[names].number;
  lines.erase(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(names));
  return lines;
}

void refuse_clipped(const std::string& file, const MeasurementFile& read) {
  if (const std::size_t clipped = clipped_samples(read.samples); clipped > 0) {
    throw InputError(fmt::format(
        "{}: the depth \"{}\" stands at 0 in the first {} samples: it is clipped "
        "before contact; tell no depth column, and it is Piezo less Cantilever",
        file, read.depth_column, clipped));
  }
}

}  // namespace

bool is_optics11(const std::filesystem::path& file, std::string_view head) {
  if (head.find("Piezo") == std::string_view::npos ||
      head.find('\0') != std::string_view::npos) {
    return false;
  }
  const auto lines = text_lines(head, file.string());
  return find_names(lines) < lines.size();
}

InstrumentFile list_optics11(const std::filesystem::path& file) {
  InstrumentFile result{.curve = {InstrumentCurve{}}};
  (void)table_lines(file, result.curve.front());
  return result;
}

MeasurementFile read_optics11(const std::filesystem::path& file, const InstrumentCurve&,
                              const InstrumentRequest& request) {
  InstrumentCurve head;
  const std::vector<TextLine> lines = table_lines(file, head);
  const MeasurementColumn piezo{"Piezo", kUnitFromHeader};
  head.columns = {piezo, {"Load", kUnitFromHeader}, std::nullopt};
  if (!matching_columns(split_cells(lines.front().text, '\t'), "Time").empty()) {
    head.columns.time = MeasurementColumn{"Time", kUnitFromHeader};
  }
  MeasurementColumns columns = given_columns(head, request);
  for (MeasurementColumn* column : {&columns.depth, &columns.force}) {
    column->unit = column->unit.empty() ? kUnitFromHeader : column->unit;
  }
  MeasurementFile result =
      read_table(file.string(), lines, columns, request.header_units);
  if (!request.given.depth.column.empty()) {
    refuse_clipped(file.string(), result);
    return result;
  }
  // depth = piezo's way - cantilever's bending.
  columns.depth = {"Cantilever", kUnitFromHeader};
  columns.time.reset();
  const MeasurementFile bending =
      read_table(file.string(), lines, columns, request.header_units);
  if (bending.samples.depth_m.size() != result.samples.depth_m.size()) {
    throw FormatError(fmt::format("{}: {} rows hold Piezo, {} hold Cantilever",
                                  file.string(), result.samples.depth_m.size(),
                                  bending.samples.depth_m.size()));
  }
  for (std::size_t i = 0; i < result.samples.depth_m.size(); ++i) {
    result.samples.depth_m[i] -= bending.samples.depth_m[i];
  }
  result.depth_column =
      fmt::format("{} - {}", result.depth_column, bending.depth_column);
  result.notes.emplace_back(
      "depth is Piezo less Cantilever, because Indentation is clipped at 0 before "
      "contact");
  return result;
}

}  // namespace palpate
