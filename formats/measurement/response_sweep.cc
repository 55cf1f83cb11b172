#include "formats/measurement/response_sweep.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/named_message.h"
#include "formats/measurement/delimited_text.h"

namespace palpate {
namespace {

constexpr const char* kSweepFirstLine = "# palpate response sweep 1";
constexpr std::string_view kErrorLine = "# error_relative ";

bool rises(const std::vector<double>& values) {
  return values.size() >= 2 && values.front() > 0.0 && std::isfinite(values.back()) &&
         std::adjacent_find(values.begin(), values.end(), [](double a, double b) {
           return !(b > a);
         }) == values.end();
}

std::vector<std::vector<double>> read_sweep_rows(const std::vector<TextLine>& lines,
                                                 std::size_t columns,
                                                 const std::string& name) {
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::vector<double> row;
    for (const std::string& cell : split_cells(lines[i].text, ',')) {
      const auto number = parse_number(cell, false);
      if (!number || !std::isfinite(*number)) {
        throw FormatError(fmt::format("{}:{}: \"{}\" is not a finite number", name,
                                      lines[i].number, cell));
      }
      row.push_back(*number);
    }
    if (row.size() != columns) {
      throw FormatError(fmt::format("{}:{}: {} cells, must be {}", name,
                                    lines[i].number, row.size(), columns));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<double> distinct(const std::vector<std::vector<double>>& rows,
                             std::size_t column) {
  std::set<double> values;
  for (const auto& row : rows) {
    values.insert(row[column]);
  }
  return {values.begin(), values.end()};
}

// Every row must be where the grid wants it.
void require_order(const ResponseSweep& sweep,
                   const std::vector<std::vector<double>>& rows,
                   const std::vector<TextLine>& lines, const std::string& name) {
  const std::size_t per_vertex = sweep.combinations() * sweep.depth_m.size();
  if (rows.size() != sweep.vertex.size() * per_vertex) {
    throw FormatError(
        fmt::format("{}: {} rows, the grid of its values has {}: rows "
                    "are missing or repeated",
                    name, rows.size(), sweep.vertex.size() * per_vertex));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<double> wanted = sweep.values_at(i % per_vertex / sweep.depth_m.size());
    wanted.insert(wanted.begin(), sweep.vertex[i / per_vertex]);
    wanted.push_back(sweep.depth_m[i % sweep.depth_m.size()]);
    if (!std::equal(wanted.begin(), wanted.end(), rows[i].begin())) {
      throw FormatError(
          fmt::format("{}:{}: the row is out of order", name, lines[i + 1].number));
    }
  }
}

double read_error(std::string_view content, const std::string& name) {
  content.remove_prefix(std::min(content.size(), content.find('\n') + 1));
  const std::string_view second = content.substr(0, content.find('\n'));
  if (!second.starts_with(kErrorLine)) {
    return 0.0;
  }
  const auto error = parse_number(second.substr(kErrorLine.size()), false);
  if (!error) {
    throw FormatError(fmt::format("{}:2: {:?} is not a number", name,
                                  second.substr(kErrorLine.size())));
  }
  return *error;
}

std::vector<std::string> read_names(const std::filesystem::path& file,
                                    const std::vector<TextLine>& lines) {
  const std::string content = read_file(file);
  const std::string first = content.substr(0, content.find('\n'));
  const auto names =
      lines.empty() ? std::vector<std::string>() : split_cells(lines[0].text, ',');
  if (first != kSweepFirstLine || names.size() < 4 || names.front() != "vertex" ||
      names[names.size() - 2] != "depth_m" || names.back() != "force_n") {
    throw FormatError(
        fmt::format("{}: is not a response sweep of version 1, whose "
                    "first line is \"{}\"",
                    file.string(), kSweepFirstLine));
  }
  return names;
}

}  // namespace

std::size_t ResponseSweep::combinations() const {
  std::size_t count = 1;
  for (const SweepParameter& p : parameter) {
    count *= p.value.size();
  }
  return count;
}

std::vector<double> ResponseSweep::values_at(std::size_t combination) const {
  std::vector<double> values(parameter.size());
  for (std::size_t j = parameter.size(); j-- > 0;) {
    const std::vector<double>& grid = parameter[j].value;
    values[j] = grid[combination % grid.size()];
    combination /= grid.size();
  }
  return values;
}

std::span<const double> ResponseSweep::curve_n(std::size_t place,
                                               std::size_t combination) const {
  return std::span(force_n).subspan(
      (place * combinations() + combination) * depth_m.size(), depth_m.size());
}

void check(const ResponseSweep& sweep) {
  if (sweep.parameter.empty() || sweep.vertex.empty()) {
    throw InputError("sweep: no parameter or no vertex");
  }
  for (const SweepParameter& p : sweep.parameter) {
    if (p.name.empty() || p.name.find_first_of(",\"\n") != std::string::npos ||
        !rises(p.value)) {
      throw InputError(
          fmt::format("sweep: parameter {:?} needs a name and at least 2 "
                      "positive, increasing values",
                      p.name));
    }
  }
  if (!rises(sweep.depth_m)) {
    throw InputError("sweep: depths must be positive and increasing, at least 2");
  }
  if (!(sweep.error_relative >= 0.0 && sweep.error_relative < 1.0)) {
    throw InputError(fmt::format("sweep: error_relative is {}, must be in [0, 1)",
                                 sweep.error_relative));
  }
  const std::size_t rows =
      sweep.vertex.size() * sweep.combinations() * sweep.depth_m.size();
  if (sweep.force_n.size() != rows) {
    throw InputError(
        fmt::format("sweep: {} forces, must be {}: vertices x grid x "
                    "depths",
                    sweep.force_n.size(), rows));
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(sweep.force_n[i] > 0.0) || !std::isfinite(sweep.force_n[i])) {
      throw InputError(fmt::format("sweep: force {} of row {} must be positive",
                                   sweep.force_n[i], i));
    }
  }
}

void write_sweep(const std::filesystem::path& file, const ResponseSweep& sweep) {
  check(sweep);
  std::string text = fmt::format("{}\n", kSweepFirstLine);
  if (sweep.error_relative > 0.0) {
    text += fmt::format("{}{}\n", kErrorLine, sweep.error_relative);
  }
  text += "vertex";
  for (const SweepParameter& p : sweep.parameter) {
    text += "," + p.name;
  }
  text += ",depth_m,force_n\n";
  for (std::size_t v = 0; v < sweep.vertex.size(); ++v) {
    for (std::size_t c = 0; c < sweep.combinations(); ++c) {
      std::string head = fmt::format("{}", sweep.vertex[v]);
      for (const double value : sweep.values_at(c)) {
        head += fmt::format(",{}", value);
      }
      for (std::size_t k = 0; k < sweep.depth_m.size(); ++k) {
        text +=
            fmt::format("{},{},{}\n", head, sweep.depth_m[k], sweep.curve_n(v, c)[k]);
      }
    }
  }
  AtomicFile out(file);
  out.write(std::as_bytes(std::span(text)));
  out.commit();
}

ResponseSweep read_sweep(const std::filesystem::path& file) {
  const std::vector<TextLine> lines = read_text_lines(file);
  const std::vector<std::string> names = read_names(file, lines);
  const auto rows = read_sweep_rows(lines, names.size(), file.string());
  ResponseSweep sweep;
  for (std::size_t j = 1; j + 2 < names.size(); ++j) {
    sweep.parameter.push_back({names[j], distinct(rows, j)});
  }
  for (const auto& row : rows) {
    const auto vertex = static_cast<std::int32_t>(row[0]);
    if (std::find(sweep.vertex.begin(), sweep.vertex.end(), vertex) ==
        sweep.vertex.end()) {
      sweep.vertex.push_back(vertex);
    }
    sweep.force_n.push_back(row.back());
  }
  sweep.depth_m = distinct(rows, names.size() - 2);
  sweep.error_relative = read_error(read_file(file), file.string());
  require_order(sweep, rows, lines, file.string());
  try {
    check(sweep);
  } catch (const InputError& error) {
    throw FormatError(with_name(file.string(), error.what()));
  }
  return sweep;
}

}  // namespace palpate
