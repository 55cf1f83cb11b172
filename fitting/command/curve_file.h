// The one press that `palpate-fit curve` reads, of a file of any layout.
#pragma once

#include <string>

#include "fitting/material/indenter_options.h"
#include "formats/measurement/instrument_file.h"

namespace palpate {

struct CurveFile {
  std::string file;
  MeasurementColumns given;  ///< empty texts: as the file tells
  HeaderUnits header_units = HeaderUnits::kMustAgree;
  int press = kNoPress;  ///< number of the press; kNoPress: the file holds one

  static constexpr int kNoPress = -1;
};

struct CurveRead {
  MeasurementFile measurement;
  std::string layout;                  ///< "Biomomentum Mach-1 text"
  std::string press;                   ///< which of how many; empty where there is one
  std::optional<double> tip_radius_m;  ///< [m] that the file states
  /// The same press with times that nobody asked for; none: the file tells none.
  std::optional<Measurement> timed;
};

/// @throws InputError for a file of several presses without a choice, naming them.
/// InputError too for a press that is not there, and as the layout's reader throws.
[[nodiscard]] CurveRead read_curve_file(const CurveFile& choice);

/// A sphere of the file's radius where the flags tell no tool; its radius where they
/// tell a sphere without one. @return what was taken, for the report; empty: nothing.
std::string take_tip(const CurveRead& read, IndenterOptions& options);

}  // namespace palpate
