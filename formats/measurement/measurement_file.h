// Reads a measured force-displacement curve from delimited text.
//
// Taken as they come: comma, tab or semicolon between cells; decimal commas where the
// comma does not separate cells; '#' comments. Taken, too, are free lines before the
// line of column names, and a line of units below the names. Taken, too, are rows in
// which all cells asked for are empty (columns of unequal length side by side).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

/// Which column of the file, and the unit of its numbers.
struct MeasurementColumn {
  std::string column;  ///< name in the header, or number counted from 1
  std::string unit;    ///< known to metres_per (depth), newtons_per (force),
                       ///< seconds_per (time), or kUnitFromHeader
};

/// The unit is the one that the header, or the line of units below it, states.
inline constexpr const char* kUnitFromHeader = "header";

/// What a lateral test has beside a displacement and a force along it.
struct LateralColumns {
  std::optional<MeasurementColumn> normal = {};  ///< force that presses
  std::optional<MeasurementColumn> across = {};  ///< displacement across the first
  std::optional<MeasurementColumn> across_force = {};
  bool normal_is_known = false;  ///< no column of normal forces is looked for
};

struct MeasurementColumns {
  MeasurementColumn depth, force;
  std::optional<MeasurementColumn> time = std::nullopt;
  /// Of a lateral test, whose depth is the lateral displacement. Rows with NaN are then
  /// left out, as a loop does without them.
  std::optional<LateralColumns> lateral = std::nullopt;
};

/// What to do where the header states another unit than the caller.
enum class HeaderUnits { kMustAgree, kIgnored };

struct MeasurementFile {
  Measurement samples;       ///< (m) in file order and in SI units
  std::string depth_column;  ///< the header's text, empty where there is none
  std::string force_column;
  std::string time_column;
  /// (m) of LateralColumns, in SI units; empty where they are not asked for
  std::vector<double> normal_n = {}, across_m = {}, across_n = {};
  std::string normal_column = {};
  /// What the reader did beyond taking columns, a clause each; empty for plain tables.
  std::vector<std::string> notes = {};
};

/// A column's name is matched exactly, else without regard to case, else also without
/// the header's unit ("Load (N)", "Load [N]", "load_N" for "load"). Signs are kept.
/// @throws InputError for a missing file, an unknown unit, or an unknown or ambiguous
/// column (naming those there are, nearest first). InputError too for a unit that the
/// header contradicts, or that it does not state, and for no rows. FormatError naming
/// line and column of a cell that is not a finite number.
[[nodiscard]] MeasurementFile read_measurement(
    const std::filesystem::path& file, const MeasurementColumns& columns,
    HeaderUnits header_units = HeaderUnits::kMustAgree);
[[nodiscard]] MeasurementFile read_measurement(
    const std::filesystem::path& file, const MeasurementColumn& depth,
    const MeasurementColumn& force, HeaderUnits header_units = HeaderUnits::kMustAgree);

}  // namespace palpate
