// `runtime_bench contacts`: what a tick of a tool with several contacts costs, and
// what their coupling makes of its force.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

struct ContactsBenchOptions {
  int ticks = 20000;  ///< of each walk, at 2 kHz
  int ticks_per_slow = 20;
  bool facets = false;  ///< the field over facets, to compare; else the smooth one
};

/// One walk of a plate over a wavy body of contrast 9.
struct ContactsBenchRow {
  int contacts = 0;
  bool coupled = false;   ///< else without compliance between contacts
  bool relaxing = false;  ///< the body does
  double friction = 0.0;
  double median_us = 0.0;    ///< [us] of step() in contact, without the clock's cost
  double p999_us = 0.0;      ///< [us] 99.9th percentile, likewise
  double touching = 0.0;     ///< contacts that carry something, mean in contact
  double evaluations = 0.0;  ///< of the curves, mean
  double factorings = 0.0;   ///< mean
  double force_max_n = 0.0;
  double lowest_work_j = 0.0;  ///< [J] <= 0, by the ledger
  bool scaled = false;         ///< C was scaled at some tick
  std::uint64_t allocations = 0;
};

/// @param allocations counter of heap allocations so far in this thread.
[[nodiscard]] std::vector<ContactsBenchRow> run_contacts_bench(
    const ContactsBenchOptions& options, std::uint64_t (*allocations)());

[[nodiscard]] std::string table_text(const std::vector<ContactsBenchRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<ContactsBenchRow>& rows);

}  // namespace palpate
