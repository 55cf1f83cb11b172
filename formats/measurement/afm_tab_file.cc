#include "formats/measurement/afm_tab_file.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/json_text.h"
#include "formats/measurement/afm_file.h"
#include "formats/measurement/delimited_text.h"
#include "formats/measurement/text_table.h"

namespace palpate {
namespace {

constexpr std::string_view kBegin = "BEGIN METADATA", kEnd = "END METADATA";

struct TabFile {
  std::string name;
  std::map<std::string, double> metadata;  // those that are numbers
  std::vector<TextLine> lines;             // the column names, then rows

  [[nodiscard]] std::optional<double> number(const char* key) const {
    const auto found = metadata.find(key);
    return found != metadata.end() ? std::optional(found->second) : std::nullopt;
  }
};

// Comment lines without '#': the metadata, and the last before the rows.
TabFile read_tab(const std::filesystem::path& file) {
  TabFile tab;
  tab.name = file.string();
  const std::string text = read_file(file);
  std::string json;
  TextLine names;
  bool inside = false;
  std::size_t number = 1;
  for (std::string_view rest = text; rest.starts_with('#'); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(1, end - 1));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    // "# BEGIN METADATA", lines of JSON, "# END METADATA"; the last other comment names
    // the columns.
    if (line == kBegin || line == kEnd) {
      inside = line == kBegin;
    } else if (inside) {
      json += line;
    } else if (!line.empty()) {
      names = {number, std::string(line)};
    }
  }
  const nlohmann::json metadata = parse_json(json);
  if (!metadata.is_object()) {
    throw FormatError(fmt::format("{}: the metadata are no JSON object", tab.name));
  }
  for (const auto& [key, value] : metadata.items()) {
    if (value.is_number()) {
      tab.metadata[key] = value.get<double>();
    }
  }
  tab.lines = read_text_lines(file);
  if (tab.lines.empty() || tab.lines.front().number != names.number) {
    tab.lines.insert(tab.lines.begin(), names);
  }
  return tab;
}

}  // namespace

bool is_afm_tab(const std::filesystem::path&, std::string_view head) {
  return head.starts_with('#') && head.find(kBegin) != std::string_view::npos;
}

InstrumentFile list_afm_tab(const std::filesystem::path& file) {
  const TabFile tab = read_tab(file);
  InstrumentCurve curve;
  curve.line = tab.lines.front().number;
  curve.spring_n_per_m = tab.number("spring constant");
  const auto x = tab.number("position x"), y = tab.number("position y");
  if (x && y) {
    curve.position_m = Eigen::Vector3d(*x, *y, 0.0);
  }
  return {.curve = {curve}};
}

MeasurementFile read_afm_tab(const std::filesystem::path& file, const InstrumentCurve&,
                             const InstrumentRequest& request) {
  const TabFile tab = read_tab(file);
  const auto names = split_cells(tab.lines.front().text, '\t');
  const auto has = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const auto* const position =
      std::find_if(std::begin(kAfmPositions), std::end(kAfmPositions), has);
  if (!has("force") || position == std::end(kAfmPositions)) {
    throw FormatError(fmt::format(
        "{}: line {} does not name the columns force and \"{}\", \"{}\" or \"{}\"",
        tab.name, tab.lines.front().number, kAfmPositions[0], kAfmPositions[1],
        kAfmPositions[2]));
  }
  MeasurementColumns columns{{*position, "m"}, {"force", "N"}, std::nullopt};
  if (request.with_time && has("time")) {
    columns.time = MeasurementColumn{"time", "s"};
  }
  MeasurementFile result = read_table(tab.name, tab.lines, columns);
  std::vector<double>& depth = result.samples.depth_m;
  const auto count = tab.number("point count");
  if (count && *count != static_cast<double>(depth.size())) {
    throw FormatError(
        fmt::format("{}: holds {} rows, its metadata count {}: it is cut "
                    "short or joined",
                    tab.name, depth.size(), *count));
  }
  // depth = -(height + F / k); a tip position has the bending F / k already.
  double bending_per_n = 0.0;
  if (position != std::begin(kAfmPositions)) {
    const auto spring = tab.number("spring constant");
    if (!spring || !(*spring > 0.0)) {
      throw FormatError(fmt::format(
          "{}: the metadata have no positive \"spring constant\", because the depth is "
          "the height less the bending it is needed",
          tab.name));
    }
    bending_per_n = 1.0 / *spring;
    result.notes.emplace_back(
        "depth is minus the height and the bending, force over "
        "spring constant");
  }
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = -(depth[i] + bending_per_n * result.samples.force_n[i]);
  }
  return result;
}

}  // namespace palpate
