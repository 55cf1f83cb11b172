// Names of columns in the header of a table: the unit inside them, and which one is
// meant.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// A header such as "Load (N)", "Load [N]", "Load, N" or "load_N", taken apart.
/// Anything in brackets at the end is a unit; after a comma or an underscore only a
/// known unit is one. After an underscore minutes and upper case are units only beside
/// a time's name ("Time_S"): "force_min" is a smallest force. As a last word a unit of
/// one letter counts only beside the name of a force or a time. So it counts in "Load
/// N", but not in "Cycle N". Units may be spelled out: "Newtons".
struct ColumnName {
  std::string quantity;  ///< "Load"
  std::string unit;      ///< "N"; empty where the header states none
};

[[nodiscard]] ColumnName parse_column_name(std::string_view header);

/// The unit as it is meant beside the name of a quantity. Grams and kilograms (g, kg)
/// of a force are gf and kgf; every other unit is itself.
[[nodiscard]] std::string unit_beside(std::string_view quantity, std::string_view unit);

/// Size of a known unit in SI base units; none for an unknown one.
[[nodiscard]] std::optional<double> length_unit_si(std::string_view unit);
[[nodiscard]] std::optional<double> force_unit_si(std::string_view unit);
[[nodiscard]] std::optional<double> time_unit_si(std::string_view unit);

/// What a column may be to a fit, in the order of MeasurementColumns.
enum Quantity : std::size_t { kDepth, kForce, kTime };
inline constexpr const char* kQuantityNames[] = {"depth", "force", "time"};
[[nodiscard]] std::optional<double> unit_si(std::size_t quantity,
                                            std::string_view unit);

/// Of a length, a force or a time.
[[nodiscard]] bool is_known_unit(std::string_view unit);

/// The column's number counted from 1, where the choice is one.
[[nodiscard]] std::optional<std::size_t> column_number(std::string_view choice);

/// Positions of the columns that `name` means: those that equal it; else those that
/// equal it without regard to case; else those whose quantity does.
[[nodiscard]] std::vector<std::size_t> matching_columns(
    const std::vector<std::string>& headers, std::string_view name);

/// The headers in quotes, nearest to `name` first (fewest single-character edits).
[[nodiscard]] std::string nearest_columns(std::vector<std::string> headers,
                                          std::string_view name);

}  // namespace palpate
