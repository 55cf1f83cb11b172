#include "runtime/attach/calibration.h"

#include <charconv>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/toml_text.h"

namespace palpate {
namespace {

constexpr const char* kCalibrationFormat = "palpate calibration";
constexpr std::int64_t kCalibrationVersion = 1;

// TOML wants a point or an exponent in a number that is no integer.
std::string number(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

double read_number(const toml::table& table, const std::filesystem::path& file,
                   const char* key, double low, double high) {
  const double value = table[key].value_or(std::nan(""));
  if (!(value >= low && value <= high)) {
    throw FormatError(
        fmt::format("{}: {} is missing or {}, must be a number in [{}, {}]",
                    file.string(), key, value, low, high));
  }
  return value;
}

}  // namespace

Calibration read_calibration(const std::filesystem::path& file) {
  constexpr std::size_t kLargest = 1 << 16;  // bytes
  const std::string text = read_file(file, kLargest, "a calibration");
  const toml::table table = [&] {
    try {
      return parse_toml(text, file.string());
    } catch (const InputError& error) {
      throw FormatError(error.what());
    }
  }();
  if (table["format"].value_or(std::string()) != kCalibrationFormat ||
      table["version"].value_or(std::int64_t{0}) != kCalibrationVersion) {
    throw FormatError(
        fmt::format("{}: is no calibration: format must be \"{}\" and "
                    "version {}",
                    file.string(), kCalibrationFormat, kCalibrationVersion));
  }
  return {.device = table["device"].value_or(std::string()),
          .motor_factor = read_number(table, file, "motor_factor", 1e-3, 10.0),
          .motor_factor_sd = read_number(table, file, "motor_factor_sd", 0.0, 10.0),
          .mass_kg = read_number(table, file, "mass_kg", 0.0, 100.0)};
}

void write_calibration(const std::filesystem::path& file,
                       const Calibration& calibration) {
  const std::string text = fmt::format(
      "format = \"{}\"\nversion = {}\ndevice = \"{}\"\nmotor_factor = {}\n"
      "motor_factor_sd = {}\nmass_kg = {}\n",
      kCalibrationFormat, kCalibrationVersion, calibration.device,
      number(calibration.motor_factor), number(calibration.motor_factor_sd),
      number(calibration.mass_kg));
  AtomicFile target(file);
  target.write(std::as_bytes(std::span(text)));
  target.commit();
}

double motor_factor(const std::string& number_or_file, const std::string& device) {
  double factor = 0.0;
  const char* const end = number_or_file.data() + number_or_file.size();
  const auto [last, error] = std::from_chars(number_or_file.data(), end, factor);
  if (error == std::errc() && last == end) {
    return factor;
  }
  const Calibration calibration = read_calibration(number_or_file);
  if (calibration.device != device) {
    throw InputError(fmt::format("--calibration {}: is of a {}, not of a {}",
                                 number_or_file, calibration.device, device));
  }
  return calibration.motor_factor;
}

}  // namespace palpate
