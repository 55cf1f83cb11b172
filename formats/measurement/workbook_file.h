// Workbooks (.xlsx, Office Open XML, ECMA-376). The tables of all sheets, as
// machine_table.h finds them in text; a row is a line, a cell a cell.
#pragma once

#include "formats/measurement/instrument_file.h"

namespace palpate {

[[nodiscard]] bool is_workbook(const std::filesystem::path& file,
                               std::string_view head);
[[nodiscard]] InstrumentFile list_workbook(const std::filesystem::path& file);
[[nodiscard]] MeasurementFile read_workbook(const std::filesystem::path& file,
                                            const InstrumentCurve& curve,
                                            const InstrumentRequest& request);

}  // namespace palpate
