// Files as instruments and testing machines write them: recognised by what they hold,
// not by their names; one press or many in each.
//
// A layout is one source with three functions (InstrumentLayout) and a line in the
// table of instrument_file.cc.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "formats/measurement/measurement_file.h"

namespace palpate {

/// One press of a file, and what the file tells of it beside the samples.
struct InstrumentCurve {
  int number = 1;  ///< as in a run's name, "a.txt#2": from 1, or the file's own number
  std::string kind =
      {};  ///< "Stress Relaxation", a sheet's name; empty where all are alike
  std::size_t line = 0;            ///< of the file, where it begins; 0: not text
  std::size_t begin = 0, end = 0;  ///< the reader's own: bytes, or rows
  std::optional<Eigen::Vector3d> position_m = {};  ///< (3) [m] the file's frame
  std::optional<Eigen::Vector3d> normal = {};      ///< (3) unit, as the file has it
  std::optional<double> tip_radius_m = {};         ///< [m] of a sphere
  std::optional<double> spring_n_per_m = {};       ///< [N/m] of a cantilever
  MeasurementColumns columns = {};  ///< the layout's choice; empty texts: by units
  std::string broken = {};          ///< why it cannot be read; empty where it can
};

struct InstrumentFile {
  std::vector<InstrumentCurve> curve;  ///< at least one
  std::string left_out = {};           ///< what the file holds beside presses
};

/// What a reader is to take instead of its own choice; empty texts: nothing.
struct InstrumentRequest {
  MeasurementColumns given = {};
  HeaderUnits header_units = HeaderUnits::kMustAgree;
  bool with_time = true;  ///< where there is one column of times
};

struct InstrumentLayout {
  std::string_view name;  ///< for people: "Biomomentum Mach-1 text"
  /// @param head the first kInstrumentHead bytes of the file
  bool (*recognises)(const std::filesystem::path& file, std::string_view head);
  /// @throws InputError, FormatError where nothing of the file can be read.
  InstrumentFile (*list)(const std::filesystem::path& file);
  /// @param curve of list(). @throws InputError, FormatError.
  MeasurementFile (*read)(const std::filesystem::path& file,
                          const InstrumentCurve& curve,
                          const InstrumentRequest& request);
};

constexpr std::size_t kInstrumentHead = 1 << 16;  ///< bytes

/// The layout of the file's content; delimited text (machine_table.h) where no other
/// one is recognised. @throws InputError for a missing file.
[[nodiscard]] const InstrumentLayout& layout_of(const std::filesystem::path& file);

/// "2 (Stress Relaxation, line 2751), 3 (...)": at most a dozen of them.
[[nodiscard]] std::string name_curves(std::span<const InstrumentCurve> curves);

/// A curve's columns: what is stated, else the layout's choice.
[[nodiscard]] MeasurementColumns given_columns(const InstrumentCurve& curve,
                                               const InstrumentRequest& request);

/// Samples at the start in which the depth is 0 to the last bit while the force is not
/// still. The depth of these samples was set to 0 before contact. 0 where the samples
/// are fewer than 8.
[[nodiscard]] std::size_t clipped_samples(const Measurement& samples);

}  // namespace palpate
