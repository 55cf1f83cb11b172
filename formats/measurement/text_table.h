// The columns of one table in delimited text, in SI units.
#pragma once

#include <span>
#include <string>

#include "formats/measurement/delimited_text.h"
#include "formats/measurement/measurement_file.h"

namespace palpate {

/// read_measurement() of lines in memory; all below the header belongs to the table.
/// @param file for messages
[[nodiscard]] MeasurementFile read_table(
    const std::string& file, std::span<const TextLine> lines,
    const MeasurementColumns& columns,
    HeaderUnits header_units = HeaderUnits::kMustAgree);

}  // namespace palpate
