// A recording of a run of the renderer: every tick of the fast process, and which
// surface elements reached it when. RECORDING.md describes the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/recording/kept_surface.h"
#include "formats/recording/tick_record.h"

namespace palpate {

constexpr std::int64_t kRecordingVersion = 5;  ///< readers take 1 to 4, too

/// What a model is called now that a file of a version names. In version 1 "potential"
/// was the field that is linear over facets.
[[nodiscard]] inline std::string recorded_model(std::int64_t version,
                                                const std::string& name) {
  return version == 1 && name == "potential" ? "facets" : name;
}

/// What was rendered, and how: enough to render it again.
struct RecordingHeader {
  std::string writer = {};           ///< tool and version
  std::string database = {};         ///< name of the file, without its folder
  std::string database_sha256 = {};  ///< its content_sha256: the logical content
  std::string tool = {};
  std::string second_tool = {};  ///< of the second hand; empty: there is one
  std::string model = {};        ///< local model
  std::string clock = {};        ///< "simulated" or "real"
  std::string device = {};       ///< name
  double fast_hz = 0.0;
  double slow_hz = 0.0;
  double force_scale =
      1.0;  ///< [-] (0, 1] forces of the database were multiplied by it
  double tool_radius_m = 0.0;
  double force_max_n = 0.0;
  double slew_max_n_per_s = 0.0;
  double energy_floor_j = 0.0;
  double recovery_m_per_s = 0.0;
  double ramp_s = 0.0;  ///< [s] of the start-up ramp
  double device_damping_n_s_per_m = 0.0;
  double device_coulomb_n = 0.0;
  double device_resolution_m = 0.0;
  double device_delay_s = 0.0;
  double poses = 0.0;  ///< 1: several contacts, whose ticks have poses and wrenches
  double torque_felt = 0.0;  ///< 1: who turned the tool felt its torque
  /// Of the virtual coupling that held the tool; mass 0: there was none.
  double coupling_mass_kg = 0.0;
  double coupling_inertia_x_kg_m2 = 0.0;
  double coupling_inertia_y_kg_m2 = 0.0;
  double coupling_inertia_z_kg_m2 = 0.0;
  double coupling_spring_n_per_m = 0.0;
  double coupling_spring_n_m_per_rad = 0.0;
  double coupling_damper_n_s_per_m = 0.0;
  double coupling_damper_n_m_s = 0.0;
  double coupling_lever_m = 0.0;
  KeptSurface surface = {};  ///< what stayed from before the first tick
};

/// How the recording ended.
struct RecordingEnd {
  std::int64_t ticks_dropped = 0;  ///< the recorder was late: not in the file
  std::int64_t arrivals_dropped = 0;
  std::string fault = "none";
};

/// Of a recording of several contacts by a program of before. Times are as they were
/// counted. Elements are missing; the slow process had answered them by so many ticks.
struct OldContactRun {
  std::vector<double> time_s;     ///< rising, a row a tick
  std::int64_t answer_ticks = 0;  ///< >= 1 from one slow update to the next
};

struct Recording {
  RecordingHeader header;
  std::vector<TickRecord> tick;
  std::vector<ArrivalRecord> arrival;  ///< in the order of their arrival
  bool ended = false;  ///< false: the writer died; what it wrote by then
  RecordingEnd end;
  std::optional<OldContactRun> old;

  [[nodiscard]] std::size_t hands() const noexcept {
    return header.second_tool.empty() ? 1 : 2;
  }
};

/// Rows are written and checked by blocks of so many: what a crash can lose.
constexpr std::size_t kRecordingBlock = 1024;

/// Reads and checks: format, types, units, checksums, finiteness, order. Of a file
/// whose writer died, the whole blocks. Takes recordings of several contacts by a
/// program of before (contact_recording.h), too. @throws InputError if it is missing,
/// FormatError if it is foreign, truncated, damaged or of another version.
[[nodiscard]] Recording read_recording(const std::filesystem::path& file);

}  // namespace palpate
