// Text of an Optics11 Piuma or Chiaro nanoindenter, one press a file: approach and
// retraction in turn. A head of key<tab>value stands first, then the columns
//   Time (s)  Load (uN)  Indentation (nm)  Cantilever (nm)  Piezo (nm)  Auxiliary
//
// Depth is Piezo less Cantilever: the column Indentation stands at 0 before contact,
// where a fit needs the free way. The radius of the tip, the spring constant and the
// stage's X and Y are taken from the head. z is 0, the plane of the stage.
#pragma once

#include "formats/measurement/instrument_file.h"

namespace palpate {

[[nodiscard]] bool is_optics11(const std::filesystem::path& file,
                               std::string_view head);
[[nodiscard]] InstrumentFile list_optics11(const std::filesystem::path& file);

/// @throws InputError for a stated depth that is clipped before contact.
[[nodiscard]] MeasurementFile read_optics11(const std::filesystem::path& file,
                                            const InstrumentCurve& curve,
                                            const InstrumentRequest& request);

}  // namespace palpate
