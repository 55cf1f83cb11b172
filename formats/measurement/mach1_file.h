// Text of a Biomomentum Mach-1 tester: "<Mach-1 File>", then blocks
//   <INFO> key:<tab>value ... <END INFO>
//   <Function> key:<tab>value ...
//   <DATA> names with units ("Fz, gf"), rows between tabs, <divider> ... <END DATA>
//
// A press is a block of a function that presses. Find Contact, moves and the rest are
// taken only from a file without such a block; Wait, Zero Load and Sinusoid never.
// Depth and force are the columns named by "Stage Axis" and "Load Cell Axis", else
// Position (z) and Fz. A normal indentation moves along "Surface Normal (x, y, z)":
// depth is the way along it, force its component, where all three are recorded.
// Position and normal of the block are the curve's, in the file's frame, lengths in mm
// where the key states no unit.
#pragma once

#include "formats/measurement/instrument_file.h"

namespace palpate {

[[nodiscard]] bool is_mach1(const std::filesystem::path& file, std::string_view head);

/// A block without its end is listed with its reason as `broken`.
/// @throws FormatError if no block presses, naming those that there are.
[[nodiscard]] InstrumentFile list_mach1(const std::filesystem::path& file);

[[nodiscard]] MeasurementFile read_mach1(const std::filesystem::path& file,
                                         const InstrumentCurve& curve,
                                         const InstrumentRequest& request);

}  // namespace palpate
