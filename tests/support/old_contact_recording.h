// Recordings of several contacts as programs of before wrote them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/forms/open_stored.h"

namespace palpate {

struct OldContactRecording {
  std::string writer = {};
  std::string database = {};
  std::string database_sha256 = {};
  std::vector<std::string> tools = {};
  std::string model = {};
  double fast_hz = 0.0;
  double slow_hz = 0.0;
  double force_scale = 1.0;
  double force_max_n = 0.0;
  double ramp_s = 0.0;
  std::string fault = "none";
  std::vector<double> time_s = {};
  RowMajor<double> pose;
  RowMajor<double> wrench;
  std::vector<std::int32_t> contacts = {};
  std::vector<double> depth_m = {};
  std::vector<double> work_j = {};
  std::vector<double> stored_j = {};
  std::vector<double> tank_j = {};
  std::vector<double> dissipated_j = {};
};

void write_old_contact_recording(const std::filesystem::path& file,
                                 const OldContactRecording& recording);

}  // namespace palpate
