// Force curves in the HDF5 layout of the Python package afmformats.
//
// One group per curve, named by its number ("0", "1", ...). In the group "force",
// "time" (where there is one) and the position of the tip are datasets of doubles of
// one length. Each has the text attribute "unit". The position is "tip position", else
// "height (measured)", else "height (piezo)". Of a height the tip's position is
// height + force / "spring constant" (attribute of the group, N/m). Heights fall while
// the tip approaches, so that depth is minus the position.
#pragma once

#include <filesystem>
#include <vector>

#include "formats/measurement/measurement_file.h"

namespace palpate {

/// Names of the position, the wanted one first.
inline constexpr const char* kAfmPositions[] = {"tip position", "height (measured)",
                                                "height (piezo)"};

/// Numbers of the curves that the file holds, ascending.
/// @throws FormatError if it is no HDF5 file or holds none.
[[nodiscard]] std::vector<int> afm_curves(const std::filesystem::path& file);

/// Curve `number`; depth grows during the approach. @throws InputError for a missing
/// file. FormatError for a dataset that is missing, of another length or unit, or holds
/// a value that is not finite.
[[nodiscard]] MeasurementFile read_afm_curve(const std::filesystem::path& file,
                                             int number);

}  // namespace palpate
