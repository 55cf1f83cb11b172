#include "formats/measurement/asked_columns.h"

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/units.h"
#include "formats/measurement/table_header.h"

namespace palpate {
namespace {

using AskedCells = std::vector<std::string>;

constexpr double (*kUnitSize[])(std::string_view) = {metres_per, newtons_per,
                                                     seconds_per};

// A stated unit of another kind or of another size is a contradiction; a text that
// is no known unit says nothing.
void check_unit(const AskedColumns& request, std::size_t which,
                const std::string& stated, std::string_view where) {
  const std::string& asked = request.column[which]->unit;
  if (request.header_units == HeaderUnits::kIgnored || asked == kUnitFromHeader) {
    return;
  }
  if (is_known_unit(stated) &&
      request.unit_si_of(which, stated) != request.given_unit(which)) {
    throw InputError(
        fmt::format("{}: {} states the unit {}, but the {} unit is given "
                    "as {}",
                    request.file, where, stated, request.what[which], asked));
  }
}

// A name that states one unit over a line of units that states another one.
void check_one_unit(const AskedColumns& request, std::size_t which,
                    const std::string& name, const std::string& above,
                    const std::string& below) {
  const bool open = request.header_units == HeaderUnits::kMustAgree ||
                    request.column[which]->unit == kUnitFromHeader;
  if (open && is_known_unit(above) &&
      request.unit_si_of(which, above) != request.unit_si_of(which, below)) {
    throw InputError(fmt::format(
        "{}: column \"{}\" states the unit {} in its name and {} below it; two systems "
        "of units in one column are not read: mend the header",
        request.file, name, above, below));
  }
}

}  // namespace

double AskedColumns::given_unit(std::size_t which) const {
  return kUnitSize[quantity[which]](column[which]->unit);
}

AskedColumns asked_columns(const std::string& file, const MeasurementColumns& columns,
                           HeaderUnits header_units, MeasurementFile& result,
                           std::string& unnamed) {
  AskedColumns request{file, header_units};
  Measurement& samples = result.samples;
  request.add(columns.depth, kDepth, columns.lateral ? "displacement" : "depth",
              samples.depth_m, result.depth_column);
  request.add(columns.force, kForce, "force", samples.force_n, result.force_column);
  if (columns.time) {
    request.add(*columns.time, kTime, "time", samples.time_s, result.time_column);
  }
  if (columns.lateral && columns.lateral->normal) {
    request.add(*columns.lateral->normal, kForce, "normal force", result.normal_n,
                result.normal_column);
  }
  if (columns.lateral && columns.lateral->across && columns.lateral->across_force) {
    request.add(*columns.lateral->across, kDepth, "displacement across",
                result.across_m, unnamed);
    request.add(*columns.lateral->across_force, kForce, "force across", result.across_n,
                unnamed);
  }
  for (std::size_t which = 0; which < request.column.size(); ++which) {
    if (request.column[which]->unit != kUnitFromHeader) {
      (void)request.given_unit(which);
    }
    if (column_number(request.column[which]->column) == std::size_t{0}) {
      throw InputError(
          fmt::format("{} column 0: columns are counted from 1", request.what[which]));
    }
  }
  return request;
}

bool numeric(const std::vector<std::string>& cells, std::size_t column) {
  return column < cells.size() && parse_number(cells[column], true).has_value();
}

bool take_unit_line(const AskedColumns& request, const TextLine& line,
                    TableLayout& table) {
  const AskedCells cells = split_cells(line.text, table.delimiter);
  AskedCells units;
  for (const std::size_t column : table.column) {
    if (column >= cells.size() || column >= table.header.size() ||
        numeric(cells, column)) {
      return false;
    }
    units.push_back(unit_beside(parse_column_name(table.header[column]).quantity,
                                stated_unit(cells[column])));
    if (!is_known_unit(units.back())) {
      return false;
    }
  }
  for (std::size_t which = 0; which < units.size(); ++which) {
    const std::size_t column = table.column[which];
    check_unit(request, which, units[which], fmt::format("line {}", line.number));
    check_one_unit(request, which, table.header[column], table.unit[column],
                   units[which]);
    table.unit[column] = units[which];
  }
  return true;
}

double unit_size(const AskedColumns& request, const TableLayout& table,
                 std::size_t which) {
  const std::size_t column = table.column[which];
  const std::string stated = column < table.unit.size() ? table.unit[column] : "";
  if (request.column[which]->unit != kUnitFromHeader) {
    if (column < table.header.size()) {
      check_unit(request, which, stated,
                 fmt::format("column \"{}\"", table.header[column]));
    }
    return request.given_unit(which);
  }
  const auto size = request.unit_si_of(which, stated);
  if (!size) {
    throw InputError(fmt::format(
        "{}: the {} unit is to be read from the header, which states {}", request.file,
        request.what[which], stated.empty() ? "none" : fmt::format("{:?}", stated)));
  }
  return *size;
}

}  // namespace palpate
