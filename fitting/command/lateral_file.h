// The runs of a lateral test that the files of `palpate-fit lateral` hold.
#pragma once

#include <string>
#include <vector>

#include "fitting/lateral/lateral_path.h"
#include "formats/measurement/instrument_file.h"

namespace palpate {

struct LateralFile {
  std::string layout;  ///< "delimited text"
  std::string displacement_column, force_column, normal_column;
  std::vector<std::string> notes;
  std::vector<LateralRun> run;  ///< at least one
};

/// Every table of a file is a run. Tables one below the other are one run where the
/// displacement goes on: the header was repeated.
/// @param given `lateral` has a value. @throws InputError, FormatError as the layout's
/// reader.
[[nodiscard]] LateralFile read_lateral_file(const std::string& file,
                                            const MeasurementColumns& given,
                                            HeaderUnits header_units);

}  // namespace palpate
