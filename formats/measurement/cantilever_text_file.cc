#include "formats/measurement/cantilever_text_file.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/units.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"
#include "formats/measurement/text_table.h"

namespace palpate {
namespace {

using Cells = std::vector<std::string>;

// Best first: what a sensor has measured goes before what was asked of the stage.
constexpr const char* kJpkHeights[] = {"measuredHeight", "smoothedMeasuredHeight",
                                       "capacitiveSensorHeight", "strainGaugeHeight",
                                       "height"};

// What the comments above a segment's rows tell: "springConstant: 0.3".
struct JpkText {
  std::map<std::string, std::string> given;
  Cells columns, units;

  [[nodiscard]] std::optional<std::size_t> column(std::string_view name) const {
    const auto found = std::find(columns.begin(), columns.end(), name);
    return found == columns.end()
               ? std::nullopt
               : std::optional(static_cast<std::size_t>(found - columns.begin()));
  }
};

void take_comment(std::string_view line, JpkText& head) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) {
    return;
  }
  const std::string key(trimmed(line.substr(1, colon - 1)));
  const std::string value(trimmed(line.substr(colon + 1)));
  head.given[key] = value;
  if (key == "columns") {
    head.columns = split_cells(value, ' ');
  } else if (key == "units") {
    head.units = split_cells(value, ' ');
  }
}

// Where depth, force and time stand, and their sizes in SI units.
struct JpkColumns {
  std::size_t height = 0, force = 0;
  std::optional<std::size_t> time;
  double metres = 1.0, newtons = 1.0, seconds = 1.0, spring_n_per_m = 0.0;
};

JpkColumns columns_of(const std::string& file, const JpkText& head) {
  JpkColumns at;
  const auto* const height = std::find_if(std::begin(kJpkHeights),
                                          std::end(kJpkHeights), [&](const char* name) {
                                            return head.column(name).has_value();
                                          });
  const auto force = head.column("vDeflection");
  if (height == std::end(kJpkHeights) || !force ||
      head.units.size() != head.columns.size()) {
    throw InputError(fmt::format(
        "{}: the JPK text lacks {}: export height and vertical deflection with units",
        file,
        height == std::end(kJpkHeights) ? "a height"
        : !force                        ? "the column vDeflection"
                                        : "a unit for each column"));
  }
  at.height = *head.column(*height);
  at.force = *force;
  // depth = -height - F / k needs the force in newtons, and k.
  const auto newtons = force_unit_si(head.units[at.force]);
  const auto given = head.given.find("springConstant");
  const auto spring =
      given == head.given.end() ? std::nullopt : parse_number(given->second, false);
  if (!newtons || !spring || !(*spring > 0.0)) {
    throw InputError(fmt::format(
        "{}: the vertical deflection is in {}, {}: export the force in N, with the "
        "spring constant",
        file, head.units[at.force],
        spring ? "no force" : "and the head states no spring constant"));
  }
  at.newtons = *newtons;
  at.metres = metres_per(head.units[at.height]);
  at.spring_n_per_m = *spring;
  at.time = head.column("seriesTime");
  return at;
}

double number_of_head(const std::string& file, const TextLine& line, const Cells& cells,
                      std::size_t column) {
  const auto value =
      column < cells.size() ? parse_number(cells[column], false) : std::nullopt;
  if (!value || !std::isfinite(*value)) {
    throw FormatError(fmt::format("{}: line {}, column {}: no finite number", file,
                                  line.number, column + 1));
  }
  return *value;
}

struct JpkRows {
  std::string file;
  bool with_time = true;
  JpkText head = {};
  JpkColumns at = {};
  bool known = false;  // `at` is the head's
  std::string segments = {};
  Measurement samples = {};

  void take(const TextLine& line) {
    if (line.text.starts_with('#')) {
      take_comment(line.text, head);
      known = false;
      return;
    }
    if (line.text.empty()) {
      return;
    }
    if (!known) {
      at = columns_of(file, head);
      known = true;
      segments += (segments.empty() ? "" : ", ") + head.given["segment"];
    }
    const Cells cells = split_cells(line.text, ' ');
    const double force_n = at.newtons * number_of_head(file, line, cells, at.force);
    const double height_m = at.metres * number_of_head(file, line, cells, at.height);
    samples.depth_m.push_back(-height_m - force_n / at.spring_n_per_m);
    samples.force_n.push_back(force_n);
    if (at.time && with_time) {
      samples.time_s.push_back(number_of_head(file, line, cells, *at.time));
    }
  }
};

// Deflection by the head: "\Spring Constant: 0.3", "Sens. DeflSens: V 36.35 nm/V".
std::optional<double> number_behind(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  std::string_view rest = text.substr(at + key.size());
  rest = rest.substr(0, rest.find_first_of("\"\r\n"));
  const std::size_t digit = rest.find_first_of("0123456789.");
  if (digit == std::string_view::npos) {
    return std::nullopt;
  }
  rest.remove_prefix(digit);
  return parse_number(rest.substr(0, rest.find_first_not_of("0123456789.eE+-")), false);
}

// The line of names, "Calc_Ramp_Ex_nm Calc_Ramp_Rt_nm Defl_pN_Ex ...".
bool is_names(const Cells& cells) {
  const auto holds = [&](std::string_view a, std::string_view b) {
    return std::any_of(cells.begin(), cells.end(), [&](const std::string& cell) {
      return cell.find(a) != std::string::npos && cell.find(b) != std::string::npos;
    });
  };
  return holds("Ramp", "_Ex") && holds("Defl", "_Ex");
}

struct NanoScope {
  std::string file;
  std::vector<TextLine> lines;
  std::size_t names = 0;
  Cells name;
  std::optional<double> spring_n_per_m, metres_per_volt;

  [[nodiscard]] std::optional<std::size_t> column(std::string_view begin,
                                                  std::string_view way,
                                                  std::string_view unit) const {
    for (std::size_t i = 0; i < name.size(); ++i) {
      const Cells parts = split_cells(name[i], '_');
      const auto has = [&](std::string_view part) {
        return std::find(parts.begin(), parts.end(), part) != parts.end();
      };
      if (name[i].starts_with(begin) && has(way) && has(unit)) {
        return i;
      }
    }
    return std::nullopt;
  }
};

NanoScope read_head(const std::filesystem::path& file) {
  NanoScope curve;
  curve.file = file.string();
  curve.lines = read_text_lines(file);
  std::string head;
  for (; curve.names < curve.lines.size(); ++curve.names) {
    curve.name = split_cells(curve.lines[curve.names].text, '\t');
    if (is_names(curve.name)) {
      break;
    }
    head += curve.lines[curve.names].text + "\n";
  }
  curve.spring_n_per_m = number_behind(head, "Spring Constant:");
  if (const auto nm = number_behind(head, "Sens. DeflSens: V")) {
    curve.metres_per_volt = 1e-9 * *nm;
  }
  return curve;
}

// Columns of one way, "Ex" or "Rt", and what makes SI of them.
struct NanoScopeWay {
  std::size_t ramp = 0, deflection = 0;
  std::optional<std::size_t> force, time;
  double metres = 1e-9, newtons = 1e-12;
};

NanoScopeWay columns_of(const NanoScope& curve, const char* way) {
  const auto ramp = curve.column("Calc_Ramp", way, "nm");
  const auto bent = curve.column("Defl", way, "nm"),
             volts = curve.column("Defl", way, "V");
  auto force = curve.column("Defl", way, "pN");
  NanoScopeWay at;
  if (!force) {
    force = curve.column("Defl", way, "nN");
    at.newtons = 1e-9;
  }
  // depth = ramp - bending. The bending is stated in nm, or is V times nm/V, or F / k.
  const bool bending =
      bent || (volts && curve.metres_per_volt) || (force && curve.spring_n_per_m);
  if (!ramp || !bending || (!force && !curve.spring_n_per_m)) {
    throw InputError(fmt::format(
        "{}: {}: export deflection in nm and force in pN, or the head with them",
        curve.file,
        !ramp ? "the ramp in nm is missing"
        : volts && !bending
            ? "the deflection is in V, and the sensitivity (nm/V) and the "
              "spring constant (N/m) are missing"
        : !force && !curve.spring_n_per_m
            ? "there is no force, and the spring constant (N/m) is missing"
            : "the deflection is missing"));
  }
  at.ramp = *ramp;
  at.force = force;
  at.time = curve.column("Time", way, "s");
  at.deflection = bent ? *bent : volts && curve.metres_per_volt ? *volts : *force;
  at.metres = bent                             ? 1e-9
              : volts && curve.metres_per_volt ? *curve.metres_per_volt
                                               : at.newtons / *curve.spring_n_per_m;
  return at;
}

void take_way(const NanoScope& curve, const NanoScopeWay& at, Measurement& samples) {
  for (std::size_t i = curve.names + 1; i < curve.lines.size(); ++i) {
    const TextLine& line = curve.lines[i];
    const Cells cells = split_cells(line.text, '\t');
    if (at.ramp >= cells.size() || cells[at.ramp].empty()) {
      continue;  // columns of unequal length
    }
    const double bent_m =
        at.metres * number_of_head(curve.file, line, cells, at.deflection);
    samples.depth_m.push_back(1e-9 * number_of_head(curve.file, line, cells, at.ramp) -
                              bent_m);
    samples.force_n.push_back(
        at.force ? at.newtons * number_of_head(curve.file, line, cells, *at.force)
                 : bent_m * *curve.spring_n_per_m);
    if (at.time) {
      samples.time_s.push_back(number_of_head(curve.file, line, cells, *at.time));
    }
  }
}

bool given(const InstrumentRequest& request) {
  return !request.given.depth.column.empty() || !request.given.force.column.empty();
}

// What the flags say of the columns goes before the head.
MeasurementFile by_flags(const std::filesystem::path& file,
                         const InstrumentRequest& request) {
  return read_measurement(file, request.given, request.header_units);
}

}  // namespace

bool is_jpk_text(const std::filesystem::path&, std::string_view head) {
  return head.starts_with('#') && head.find("# columns:") != std::string_view::npos &&
         head.find("# units:") != std::string_view::npos &&
         head.find("vDeflection") != std::string_view::npos;
}

bool is_nanoscope_text(const std::filesystem::path&, std::string_view head) {
  return head.find('\0') == std::string_view::npos &&
         head.find("Calc_Ramp_Ex_nm") != std::string_view::npos &&
         head.find("Defl_") != std::string_view::npos;
}

MeasurementFile read_jpk_text(const std::filesystem::path& file, const InstrumentCurve&,
                              const InstrumentRequest& request) {
  if (given(request)) {
    return by_flags(file, request);
  }
  const std::string text = read_file(file);
  JpkRows rows{.file = file.string(), .with_time = request.with_time};
  std::size_t number = 1;
  // Comments between the rows begin another segment, and may state other columns.
  for (std::string_view rest = text; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    rows.take({number, std::string(trimmed(rest.substr(0, end)))});
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (rows.samples.force_n.empty()) {
    throw InputError(fmt::format("{}: no row of numbers", file.string()));
  }
  MeasurementFile result{.samples = std::move(rows.samples),
                         .depth_column = fmt::format("-{} - vDeflection / k",
                                                     rows.head.columns[rows.at.height]),
                         .force_column = "vDeflection",
                         .time_column = ""};
  result.time_column = result.samples.time_s.empty() ? "" : "seriesTime";
  result.notes.push_back(fmt::format("spring constant {} N/m, segments {}",
                                     rows.at.spring_n_per_m, rows.segments));
  return result;
}

MeasurementFile read_nanoscope_text(const std::filesystem::path& file,
                                    const InstrumentCurve&,
                                    const InstrumentRequest& request) {
  if (given(request)) {
    return by_flags(file, request);
  }
  const NanoScope curve = read_head(file);
  MeasurementFile result{
      .samples = {}, .depth_column = "", .force_column = "", .time_column = ""};
  const NanoScopeWay approach = columns_of(curve, "Ex");
  take_way(curve, approach, result.samples);
  if (curve.column("Calc_Ramp", "Rt", "nm")) {
    take_way(curve, columns_of(curve, "Rt"), result.samples);
  }
  if (!request.with_time ||
      result.samples.time_s.size() != result.samples.depth_m.size()) {
    result.samples.time_s.clear();
  }
  result.depth_column = fmt::format("{} - {}", curve.name[approach.ramp],
                                    curve.name[approach.deflection]);
  result.force_column = curve.name[approach.force.value_or(approach.deflection)];
  return result;
}

}  // namespace palpate
