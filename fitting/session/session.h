// Session files: which measurements belong together and what is known of them
// (fitting/session/SESSION.md).
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "fitting/curve/curve_family.h"
#include "fitting/curve/measured_approach.h"
#include "fitting/curve/press_cycles.h"
#include "fitting/material/indenter.h"
#include "fitting/session/rigid_registration.h"
#include "formats/measurement/instrument_file.h"
#include "formats/measurement/measurement_file.h"
#include "formats/response/tool_shape.h"

namespace palpate {

inline constexpr std::array<std::string_view, 3> kCriteria{"aicc", "bic",
                                                           "cross-validation"};

/// One file of the session, or one curve of a file that holds several.
struct SessionRun {
  std::filesystem::path file;
  int curve = 0;      ///< number inside a file that holds several
  std::string name;   ///< unique: the path as the session writes it, "#" and the curve
  std::string point;  ///< repeats at one place share it; else the name
  std::string specimen;  ///< points of one share it; empty: not given
  std::optional<Eigen::Vector3d> position_m;  ///< (3) [m] on the body, its mesh's frame
  std::optional<Eigen::Vector3d> normal;      ///< (3) unit, outward
  std::optional<InstrumentCurve>
      instrument;               ///< of kAuto, where the file can be listed
  bool placed_by_file = false;  ///< the position is the instrument's
};

enum class SessionLayout { kText, kAfmHdf5, kAuto };

struct SessionFit {
  FitRange range;
  std::optional<FitRange> baseline;   ///< displacements that are surely before contact
  double noise_relative = 0.0;        ///< [-] [0, 1) noise that grows with force
  std::vector<std::string> families;  ///< of kFamilyNames, at least one
  std::string criterion = "aicc";     ///< one of kCriteria
  std::optional<CycleChoice> cycle;   ///< which presses of a file; none: not given
};

/// The frame's stiffness as stated, or the file of a run on a rigid plate; or neither.
struct SessionMachine {
  double frame_stiffness_n_per_m = 0.0;  ///< [N/m] > 0; 0: not stated
  double frame_stiffness_sd_n_per_m = std::numeric_limits<double>::quiet_NaN();
  std::filesystem::path frame_run;
};

struct Session {
  std::string text;            ///< the file, as it was read
  std::filesystem::path file;  ///< where from
  std::string name;
  SessionLayout layout = SessionLayout::kText;
  MeasurementColumns columns;  ///< of kText; of kAuto what is given, else empty texts
  HeaderUnits header_units = HeaderUnits::kMustAgree;
  Indenter indenter;
  /// The indenter as the database holds it; none of a plate and of the unknown.
  std::optional<ToolShape> tool;
  std::filesystem::path mesh;  ///< the body's surface; empty where none is named
  std::string length_unit;     ///< of the mesh
  std::string points_unit;     ///< of the table of points; empty: none was read
  SessionFit fit;
  SessionMachine machine;
  /// From the machine's frame to the mesh's: positions and normals are moved already.
  std::optional<Registration> registration;
  std::vector<SessionRun> run;  ///< at least one, in the session's order
  /// What the session took from files of kAuto, a line each.
  std::vector<std::string> notes;
};

/// Files of runs are not opened, but globs are expanded (in the order of the alphabet).
/// Afmformats files and those of layout "auto" are asked for their curves.
/// @throws InputError "session.toml:12: ..." naming key, value and what is allowed.
/// InputError too for a glob without a match, and a run named twice. InputError too for
/// a row of the table of points that fits no file, and a file without a row there.
[[nodiscard]] Session read_session(const std::filesystem::path& file);

/// What was taken from the files, a line "read   ..." each, at most 20.
[[nodiscard]] std::string describe_notes(const Session& session);

/// Displacement and force, and time where the session names it, of one run.
/// @throws InputError or FormatError as read_measurement(), read_afm_curve() and the
/// readers of instrument_file.h do.
[[nodiscard]] MeasurementFile read_run(const Session& session, const SessionRun& run);

}  // namespace palpate
