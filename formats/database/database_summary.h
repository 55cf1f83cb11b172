// What a response database holds, in a few numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/database/database_index.h"
#include "formats/database/response_database.h"

namespace palpate {

/// One tool's responses in a few numbers; the largest are 0 without responses.
struct ToolSummary {
  ToolShape tool;
  std::int64_t responses = 0;  ///< nodes that have a curve
  std::int64_t simulated = 0;
  std::int64_t interpolated = 0;
  std::int64_t measured = 0;
  std::int64_t falling = 0;               ///< curves whose force falls with depth
  std::int64_t force_capped = 0;          ///< end at the scene's largest force
  std::int64_t coarse_contact = 0;        ///< contact radius below 1.5 node spacings
  std::int64_t error_over_budget = 0;     ///< outside the scene's accuracy budget
  std::int64_t failed = 0;                ///< solves that failed: no curve
  std::int64_t extrapolated = 0;          ///< beyond the curves they come from
  std::int64_t truncated_path = 0;        ///< they end early
  std::int64_t near_singular = 0;         ///< other equilibria may lie near
  double depth_max_m = 0.0;               ///< [m]
  double force_max_n = 0.0;               ///< [N] of any sample
  double stiffness_max_n_per_m = 0.0;     ///< [N/m] largest slope
  double error_relative_max = 0.0;        ///< [-] largest stated error
  double direction_spread_max_rad = 0.0;  ///< [rad]
  ResponseRelaxation relaxation;          ///< empty where none is known
  Viscoelasticity viscoelasticity;        ///< as rendered, without rows; or empty
  ShareExtent shares;                     ///< its shares
  std::int64_t memory_sites = 0;          ///< its sites; 0: every node is one
  std::string yielding = {};  ///< how responses yield, one line; empty: they do not
  ComplianceTable compliance = {};  ///< without rows; empty: contacts do not couple
  std::string contact = {};         ///< describe() of its contact table
  Puncture puncture = {};           ///< with its rows; empty: nothing is punctured
  AccuracyRecord accuracy;
};

/// "hold at 95 % of places: ...", in a sentence's end: how a tool's stated errors were
/// found. Empty where no computation says.
[[nodiscard]] std::string describe(const AccuracyRecord& accuracy);

/// Its end: what 95 % of places are within from which depth on; empty where nobody
/// knows.
[[nodiscard]] std::string describe_depths(const AccuracyRecord& accuracy);

/// Spacing of a tool's memory sites in contact radii of a press to half the largest
/// depth; 0 where there are none.
[[nodiscard]] double spacing_in_contact_radii(const ToolSummary& tool);

/// One line for people: where the surface remembers, and doubts of it.
/// @param tool whose responses relax.
[[nodiscard]] std::string describe_memory(const ToolSummary& tool);

/// Why memory at these sites may not be what a slow press meets: they are finer or
/// coarser than contacts, or not known. In a sentence's end; empty without doubts.
[[nodiscard]] std::string doubts_of_memory(const ToolSummary& tool);

/// One line for people: what the tool punctures, and doubts of it; empty for nothing.
[[nodiscard]] std::string describe_puncture(const ToolSummary& tool);

/// Doubts alone, of its numbers and of the depth of its curves; empty without any.
[[nodiscard]] std::string doubts_of_puncture(const ToolSummary& tool);

[[nodiscard]] ToolSummary summarise(const ResponseTable& table);

/// The same from the index alone: no response is read.
[[nodiscard]] ToolSummary summarise(const ToolIndex& tool);

}  // namespace palpate
