// What a device's motors really give, kept in a file between runs.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// A TOML file: format = "palpate calibration", version = 1, and a key for each field.
struct Calibration {
  std::string device;            ///< name that --device takes
  double motor_factor = 1.0;     ///< [-] (0, 10] on motor commands
  double motor_factor_sd = 0.0;  ///< [-] >= 0 standard deviation of it
  double mass_kg = 0.0;          ///< [kg] > 0 that was hung up
};

/// @throws InputError if the file cannot be read, FormatError for one that is no
/// calibration or holds a value out of range.
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& file);

/// Written whole or not at all. @throws InputError where it cannot be written.
void write_calibration(const std::filesystem::path& file,
                       const Calibration& calibration);

/// What --calibration means: a number, or a file of that device. @throws InputError,
/// and as read_calibration().
[[nodiscard]] double motor_factor(const std::string& number_or_file,
                                  const std::string& device);

}  // namespace palpate
