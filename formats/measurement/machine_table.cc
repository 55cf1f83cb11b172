#include "formats/measurement/machine_table.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "formats/measurement/column_choice.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/table_header.h"
#include "formats/measurement/text_table.h"

namespace palpate {
namespace {

using Columns = std::vector<std::size_t>;

constexpr double kMoves = 5.0;  // standard deviations

MeasurementColumn by_number(std::size_t column) {
  return {std::to_string(column + 1), kUnitFromHeader};
}

// A name whose numbers are all the same one: "Y_gel_#_Fn".
std::string without_numbers(const std::string& name) {
  std::string text;
  for (const char c : name) {
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (!digit || text.empty() || text.back() != '#') {
      text += digit ? '#' : c;
    }
  }
  return text;
}

// Whether the columns have one name, but for its number: presses side by side.
bool of_one_name(const TableHeader& header, const Columns& columns) {
  return std::all_of(columns.begin(), columns.end(), [&](std::size_t column) {
    return without_numbers(header.name[column]) ==
           without_numbers(header.name[columns.front()]);
  });
}

// Layouts of several lengths in which one is known to be the way of the tool.
constexpr const char* kDisplacements[][2] = {
    {"SetName", "Displacement_mm"},  // CellScale: beside Size_mm, the gap
};

std::optional<std::size_t> known_depth(const TableHeader& header) {
  for (const auto& [sign, depth] : kDisplacements) {
    const auto named = [&](const char* name) {
      return std::find(header.name.begin(), header.name.end(), name);
    };
    if (named(sign) != header.name.end() && named(depth) != header.name.end()) {
      return static_cast<std::size_t>(named(depth) - header.name.begin());
    }
  }
  return std::nullopt;
}

// One table below its header: what its columns tell by their units. Where they tell
// too much, the reader asks.
std::vector<InstrumentCurve> curves_of(const TableHeader& header) {
  const Columns depth = columns_with_unit(header, kDepth),
                force = columns_with_unit(header, kForce),
                time = columns_with_unit(header, kTime);
  const bool several = force.size() > 1 && depth.size() == force.size() &&
                       (time.size() <= 1 || time.size() % force.size() == 0) &&
                       of_one_name(header, depth) && of_one_name(header, force);
  std::vector<InstrumentCurve> curves(several ? force.size() : 1);
  for (std::size_t i = 0; several && i < curves.size(); ++i) {
    curves[i].columns.depth = by_number(depth[i]);
    curves[i].columns.force = by_number(force[i]);
    if (!time.empty()) {
      curves[i].columns.time = by_number(time[i * time.size() / curves.size()]);
    }
  }
  if (const auto known = known_depth(header); known && !several) {
    curves.front().columns.depth = {chosen_by(header, *known), kUnitFromHeader};
  }
  if (!several && time.size() == 1) {
    curves.front().columns.time =
        MeasurementColumn{chosen_by(header, time.front()), kUnitFromHeader};
  }
  return curves;
}

// Whether the force goes on in one direction in the first samples, more than from one
// to the next: a motor that has yet to start moves nothing.
bool force_moves(const Measurement& samples, std::size_t count) {
  const auto f = std::span(samples.force_n).first(count);
  const std::size_t half = count / 2;
  const auto mean = [](std::span<const double> part) {
    return std::accumulate(part.begin(), part.end(), 0.0) /
           static_cast<double>(part.size());
  };
  double squares = 0.0;
  for (std::size_t i = 1; i < count; ++i) {
    squares += 0.5 * (f[i] - f[i - 1]) * (f[i] - f[i - 1]);
  }
  const double sd = std::sqrt(squares / static_cast<double>((count - 1) * half) * 2.0);
  return std::abs(mean(f.last(half)) - mean(f.first(half))) > kMoves * sd;
}

struct Table {
  TableHeader header;
  std::size_t end = 0;  // of its lines

  [[nodiscard]] bool presses() const {
    return !columns_with_unit(header, kDepth).empty() &&
           !columns_with_unit(header, kForce).empty();
  }
  [[nodiscard]] bool timed() const { return !columns_with_unit(header, kTime).empty(); }
};

bool has_number(const TextLine& line, char delimiter) {
  const auto cells = split_cells(line.text, delimiter);
  return std::any_of(cells.begin(), cells.end(), [&](const std::string& cell) {
    return parse_number(cell, true).has_value();
  });
}

// Every header with units begins a table; titles and footers, which hold no number,
// end it.
std::vector<Table> split_tables(std::span<const TextLine> lines) {
  const auto first = find_header(lines);
  std::vector<Table> tables;
  if (!first) {
    return tables;
  }
  const char delimiter = first->delimiter;
  for (std::size_t at = 0; at < lines.size();) {
    auto header = find_header(lines, delimiter, at);
    if (!header) {
      break;
    }
    const bool stated = std::any_of(header->unit.begin(), header->unit.end(),
                                    [](const std::string& unit) {
                                      return is_known_unit(unit);
                                    });
    std::size_t end = header->begin;
    while (end < lines.size() && is_number_row(lines, end, delimiter)) {
      ++end;
    }
    at = end;
    if (stated) {
      tables.push_back({std::move(*header), end});
    } else if (!tables.empty()) {
      tables.back().end = end;  // what stands between is no header: a damaged row
    }
  }
  for (std::size_t i = 0; i < tables.size(); ++i) {
    std::size_t& end = tables[i].end;
    end = i + 1 < tables.size() ? tables[i + 1].header.names : lines.size();
    while (end > tables[i].header.begin && !has_number(lines[end - 1], delimiter)) {
      --end;
    }
  }
  return tables;
}

}  // namespace

bool is_text(const std::filesystem::path&, std::string_view) {
  return true;
}

std::vector<InstrumentCurve> tables_in(std::span<const TextLine> lines) {
  std::vector<Table> tables = split_tables(lines);
  std::erase_if(tables, [](const Table& table) {
    return !table.presses();
  });
  const bool timed = std::any_of(tables.begin(), tables.end(), [](const Table& table) {
    return table.timed();
  });
  // Beside tables of samples in time, one without time is a summary.
  std::erase_if(tables, [&](const Table& table) {
    return timed && !table.timed();
  });
  std::vector<InstrumentCurve> curves;
  for (const Table& table : tables) {
    for (InstrumentCurve& curve : curves_of(table.header)) {
      curve.number = static_cast<int>(curves.size()) + 1;
      curve.line = lines[table.header.names].number;
      curve.begin = table.header.names;
      curve.end = table.end;
      curves.push_back(std::move(curve));
    }
  }
  if (curves.empty()) {
    curves.push_back({.end = lines.size()});
  }
  return curves;
}

MeasurementFile read_lines(const std::string& file, std::span<const TextLine> lines,
                           const InstrumentCurve& curve,
                           const InstrumentRequest& request) {
  const auto part = lines.subspan(curve.begin, curve.end - curve.begin);
  std::vector<std::string> notes;
  const MeasurementColumns columns =
      columns_of_lines(file, part, given_columns(curve, request), &notes);
  MeasurementFile result = read_table(file, part, columns, request.header_units);
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  if (const std::size_t clipped = clipped_samples(result.samples);
      clipped > 0 && force_moves(result.samples, clipped)) {
    result.notes.push_back(fmt::format(
        "the depth stands at 0 in the first {} samples: if it was clipped before "
        "contact, take the way of the tool instead",
        clipped));
  }
  return result;
}

InstrumentFile list_tables(const std::filesystem::path& file) {
  return {.curve = tables_in(read_text_lines(file))};
}

MeasurementFile read_machine_table(const std::filesystem::path& file,
                                   const InstrumentCurve& curve,
                                   const InstrumentRequest& request) {
  const std::vector<TextLine> lines = read_text_lines(file);
  InstrumentCurve inside = curve;
  inside.end = std::min(inside.end, lines.size());
  inside.begin = std::min(inside.begin, inside.end);
  return read_lines(file.string(), lines, inside, request);
}

}  // namespace palpate
