// `runtime_bench stream`: what it takes to touch a body that does not fit memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/slow/chunk_cache.h"

namespace palpate {

struct StreamBenchOptions {
  std::filesystem::path database;  ///< a stream_body(); empty: generated
  std::int64_t nodes = 1'000'000;  ///< of a generated body
  int samples = 32;                ///< per curve of it
  bool keep = false;               ///< leave the generated file
  double seconds = 10.0;           ///< [s] > 0 of each run
  double speed_m_per_s = 1.0;      ///< [m/s] >= 0
  double slow_hz = 100.0;          ///< [Hz] > 0
  std::size_t budget_bytes = 48 * kMebibyte;
};

struct StreamBenchRow {
  double triangle_m = 0.0;  ///< [m] edge
  bool cold = false;        ///< the file was dropped from the page cache before
  std::int64_t updates = 0;
  std::int64_t starved = 0;           ///< updates without what they needed
  std::int64_t missed_deadlines = 0;  ///< slow periods that the machine skipped
  std::int64_t chunks_loaded = 0;
  double hit_share = 0.0;       ///< [-] of chunks there before they were asked for
  double load_median_ms = 0.0;  ///< [ms] per chunk
  double load_p99_ms = 0.0;     ///< [ms]
  double update_max_ms = 0.0;   ///< [ms] longest slow step
  std::size_t budget_used_bytes = 0;
};

struct StreamBenchReport {
  std::filesystem::path database;
  std::int64_t nodes = 0;
  std::uintmax_t file_bytes = 0;
  double speed_m_per_s = 0.0;
  std::size_t budget_bytes = 0;
  std::size_t resident_bytes = 0;  ///< peak above the program before it opened the file
  std::vector<StreamBenchRow> rows = {};
};

/// A tool in contact goes straight over each plate, reflected at its border, in real
/// time. The tool does so with the file in the page cache, and after the file was
/// dropped from it.
/// @throws InputError for options out of range, and as StreamedElements does.
[[nodiscard]] StreamBenchReport run_stream_bench(const StreamBenchOptions& options);

[[nodiscard]] std::string table_text(const StreamBenchReport& report);
[[nodiscard]] std::string to_json(const StreamBenchReport& report);

}  // namespace palpate
