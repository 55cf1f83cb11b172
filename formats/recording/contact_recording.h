// A recording of a tool with several contacts, or of two hands on one body: the pose of
// each hand at every tick, and what was rendered there. RECORDING.md describes the
// file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/hdf5/hdf5_io.h"

namespace palpate {

/// Readers take 1, too, and no other: without a model, which was "facets".
constexpr std::int64_t kContactRecordingVersion = 2;

struct ContactRecording {
  std::string writer = {};              ///< tool and version
  std::string database = {};            ///< name of the file, without its folder
  std::string database_sha256 = {};     ///< its content_sha256
  std::vector<std::string> tools = {};  ///< 1, or 2 for two hands
  std::string model = {};               ///< local model
  double fast_hz = 0.0;                 ///< [Hz] of the first tick; then by time_s
  double slow_hz = 0.0;                 ///< [Hz]
  double force_scale = 1.0;             ///< [-] (0, 1]
  double force_max_n = 0.0;             ///< [N]
  double ramp_s = 0.0;                  ///< [s] of the start-up ramp
  std::string fault = "none";           ///< what ended the run

  // A row for each tick.
  std::vector<double> time_s = {};  ///< rising
  /// (rows x 7 hands) for each hand x y z [m] of the reference point and the unit
  /// quaternion x y z w from the tool's frame to the body's.
  RowMajor<double> pose;
  /// (rows x 6 hands) for each hand force [N] and torque about its reference point
  /// [N m], on the tool, in the body's frame.
  RowMajor<double> wrench;
  std::vector<std::int32_t> contacts = {};  ///< that carried something
  std::vector<double> depth_m = {};         ///< of the deepest
  std::vector<double> work_j = {};          ///< put in since the start, by the ledger
  std::vector<double> stored_j = {};
  std::vector<double> tank_j = {};
  std::vector<double> dissipated_j = {};

  [[nodiscard]] std::int64_t hands() const {
    return static_cast<std::int64_t>(tools.size());
  }
};

/// Writes it whole or not at all. @throws InputError if the place cannot be written.
void write_contact_recording(const std::filesystem::path& file,
                             const ContactRecording& recording);

/// Whether a file says that it is one; false for what cannot be opened.
[[nodiscard]] bool is_contact_recording(const std::filesystem::path& file);

/// Reads and checks. @throws InputError if it is missing, FormatError if it is foreign,
/// damaged, of another version, or its values break the rules above.
[[nodiscard]] ContactRecording read_contact_recording(
    const std::filesystem::path& file);

}  // namespace palpate
