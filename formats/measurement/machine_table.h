// Tables of testing machines in delimited text: Instron Bluehill, ZwickRoell testXpert,
// Exponent of the TA.XT, CellScale; and every other text of names, units and numbers.
//
// A file may hold several tables, each below names and units of its own ("Results Table
// 1"). Tables with a length and a force are presses. Where some of them have times,
// these alone are presses: a table of results has no times. Columns of one name side by
// side are presses in turn.
#pragma once

#include "formats/measurement/delimited_text.h"
#include "formats/measurement/instrument_file.h"

namespace palpate {

/// Delimited text of any kind: the layout that is left where no other is recognised.
[[nodiscard]] bool is_text(const std::filesystem::path& file, std::string_view head);

[[nodiscard]] InstrumentFile list_tables(const std::filesystem::path& file);
[[nodiscard]] MeasurementFile read_machine_table(const std::filesystem::path& file,
                                                 const InstrumentCurve& curve,
                                                 const InstrumentRequest& request);

/// The presses among lines: curves with `begin` and `end` as places in `lines`. All
/// lines are one curve where no table has a length and a force.
[[nodiscard]] std::vector<InstrumentCurve> tables_in(std::span<const TextLine> lines);

/// A curve of tables_in().
[[nodiscard]] MeasurementFile read_lines(const std::string& file,
                                         std::span<const TextLine> lines,
                                         const InstrumentCurve& curve,
                                         const InstrumentRequest& request);

}  // namespace palpate
