// Tab-separated force curves of the Python package afmformats (".tab"), one curve a
// file. Comment lines hold metadata as JSON between BEGIN METADATA and END METADATA. A
// comment line of column names follows, then rows in SI units.
//
// Columns and signs as in afm_file.h: depth is minus the position of the tip.
#pragma once

#include "formats/measurement/instrument_file.h"

namespace palpate {

[[nodiscard]] bool is_afm_tab(const std::filesystem::path& file, std::string_view head);
[[nodiscard]] InstrumentFile list_afm_tab(const std::filesystem::path& file);

/// @throws FormatError for other columns, and where the metadata count other rows.
[[nodiscard]] MeasurementFile read_afm_tab(const std::filesystem::path& file,
                                           const InstrumentCurve& curve,
                                           const InstrumentRequest& request);

}  // namespace palpate
