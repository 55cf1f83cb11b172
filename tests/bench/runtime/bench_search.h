// `runtime_bench search`: what finding the contact costs the slow process.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

struct SearchBenchOptions {
  std::vector<std::int64_t> triangles{10'000, 100'000, 1'000'000};  ///< [2, 10^8] each
  int queries = 20'000;  ///< of each kind, >= 1
};

struct SearchBenchRow {
  std::int64_t triangles = 0;
  double build_s = 0.0;          ///< [s] of the tree of boxes
  double first_median_ns = 0.0;  ///< [ns] nearest point anywhere, tool up to 10 mm off
  double first_p999_ns = 0.0;    ///< [ns] 99.9th percentile
  double slide_median_ns = 0.0;  ///< [ns] walk to where the tool is 1 mm on
  double slide_p999_ns = 0.0;    ///< [ns] 99.9th percentile
  double press_median_ns = 0.0;  ///< [ns] walk of a tool that is where it was, deeper
  double press_p999_ns = 0.0;    ///< [ns] 99.9th percentile
};

/// On a wavy surface of edges of 1 mm. Times are less the clock's own, the median of
/// empty readings. @throws InputError for options out of range.
[[nodiscard]] std::vector<SearchBenchRow> run_search_bench(
    const SearchBenchOptions& options);

[[nodiscard]] std::string table_text(const std::vector<SearchBenchRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<SearchBenchRow>& rows);

}  // namespace palpate
