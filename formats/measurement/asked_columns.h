// The columns of a table that are asked for, where their samples go, and their units.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"
#include "formats/measurement/measurement_file.h"

namespace palpate {

/// Where a table lies in its lines.
struct TableLayout {
  char delimiter = ',';
  std::vector<std::string> header;  ///< empty where the file has none
  std::vector<std::string> unit;    ///< as many; empty texts where none is stated
  std::size_t begin = 0;            ///< first line below the header
  std::vector<std::size_t> column;  ///< of each column that is asked for
};

/// Of each column: what it is, and where its samples and its name go.
struct AskedColumns {
  std::string file;  ///< for messages
  HeaderUnits header_units;
  std::vector<const MeasurementColumn*> column = {};
  std::vector<std::size_t> quantity = {};
  std::vector<const char*> what = {};  ///< for messages: "normal force"
  std::vector<std::vector<double>*> samples = {};
  std::vector<std::string*> name = {};

  void add(const MeasurementColumn& asked, std::size_t of, const char* called,
           std::vector<double>& into, std::string& named) {
    column.push_back(&asked);
    quantity.push_back(of);
    what.push_back(called);
    samples.push_back(&into);
    name.push_back(&named);
  }
  [[nodiscard]] std::optional<double> unit_si_of(std::size_t which,
                                                 std::string_view unit) const {
    return unit_si(quantity[which], unit);
  }
  /// [-] SI units in the one that was given.
  [[nodiscard]] double given_unit(std::size_t which) const;
};

/// @param result takes the samples and the names; must outlive what is returned, as
/// `columns` must. @param unnamed takes the names that nobody wants.
/// @throws InputError for an unknown unit, or a column 0.
[[nodiscard]] AskedColumns asked_columns(const std::string& file,
                                         const MeasurementColumns& columns,
                                         HeaderUnits header_units,
                                         MeasurementFile& result, std::string& unnamed);

/// Whether a cell is a number, NaN among them.
[[nodiscard]] bool numeric(const std::vector<std::string>& cells, std::size_t column);

/// The line below the header, if it holds units; no cell is a number then. Its units
/// are the table's. @throws InputError where they contradict what was asked for.
[[nodiscard]] bool take_unit_line(const AskedColumns& request, const TextLine& line,
                                  TableLayout& table);

/// SI units in one of the column's: as it was given, or as header or unit line state
/// it.
/// @throws InputError as take_unit_line(), or where the header states none.
[[nodiscard]] double unit_size(const AskedColumns& request, const TableLayout& table,
                               std::size_t which);

}  // namespace palpate
