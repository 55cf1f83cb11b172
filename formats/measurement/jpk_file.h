// Force curves of JPK (Bruker) atomic force microscopes: .jpk-force, .jpk-force-map,
// .jpk-qi-data, .jpk-qi-series; zip archives of headers and raw channels.
//
// A map's curves have the file's own numbers, from 0. Segments follow one another:
// approach, pause, retraction. Force is vDeflection in its slot "force". Depth is minus
// the position of the tip: the height plus the bending, which is vDeflection in its
// slot "distance". The height is the first of measuredHeight, capacitiveSensorHeight,
// strainGaugeHeight and height that the file has.
#pragma once

#include "formats/measurement/instrument_file.h"

namespace palpate {

[[nodiscard]] bool is_jpk(const std::filesystem::path& file, std::string_view head);

/// Positions are those of the scanner, z 0.
[[nodiscard]] InstrumentFile list_jpk(const std::filesystem::path& file);

/// @throws FormatError for a broken archive, a channel that is missing, not calibrated
/// or shorter than its header says.
[[nodiscard]] MeasurementFile read_jpk(const std::filesystem::path& file,
                                       const InstrumentCurve& curve,
                                       const InstrumentRequest& request);

}  // namespace palpate
