// Force curves of cantilevers as their instruments export them as text. JPK: "TEXT
// EXPORT" with columns, units and spring constant in comments, a block a segment.
// NanoScope: names that end in Ex and Rt, approach and retract side by side.
//
// Depth is what the cantilever's foot moves less its bending: minus height less force
// over spring constant (JPK), ramp less deflection (NanoScope).
#pragma once

#include <filesystem>
#include <string_view>

#include "formats/measurement/instrument_file.h"

namespace palpate {

[[nodiscard]] bool is_jpk_text(const std::filesystem::path& file,
                               std::string_view head);
[[nodiscard]] bool is_nanoscope_text(const std::filesystem::path& file,
                                     std::string_view head);

/// Segments in a row, with times where there is a series time. @throws FormatError
/// naming the line; InputError where force, height or spring constant lack.
[[nodiscard]] MeasurementFile read_jpk_text(const std::filesystem::path& file,
                                            const InstrumentCurve& curve,
                                            const InstrumentRequest& request);

/// Approach, then retract. The force is that in pN or nN, else deflection times the
/// spring constant of the head. @throws FormatError naming the line; InputError saying
/// which of deflection, sensitivity and spring constant lacks.
[[nodiscard]] MeasurementFile read_nanoscope_text(const std::filesystem::path& file,
                                                  const InstrumentCurve& curve,
                                                  const InstrumentRequest& request);

}  // namespace palpate
