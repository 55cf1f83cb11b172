// What accuracy costs on a scene: its responses at a few vertices, computed in every
// way that a build could, beside time and memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "precompute/process/progress.h"
#include "precompute/surface/repair.h"

namespace palpate {

struct AccuracyTradeOptions {
  RepairMode repair = RepairMode::kOff;  ///< as BuildOptions
  int samples = 6;  ///< [2, 1000] vertices that are pressed in every way
  /// [-] (0, 16] each; elements that the radius of the contact spans.
  std::vector<double> resolution{2.0, 3.0, 4.0};
  std::vector<int> depths{5, 10, 20};  ///< [2, 64] each
  double reference_finer =
      1.5;  ///< [-] [1, 8] the reference over the finest resolution
};

/// One way to compute the scene, of the time that all its nodes would take.
struct AccuracyTradeRow {
  double resolution = 0.0;    ///< [-]
  bool nonlinear = false;     ///< else linear
  bool interpolated = false;  ///< most nodes from the few that are solved well
  int depths = 0;
  std::int64_t compared = 0;           ///< sampled vertices that have a response
  double error_rms = 0.0;              ///< [-] of force, over vertices and depths
  double error_largest = 0.0;          ///< [-] rms over depths, of the worst vertex
  double cpu_seconds = 0.0;            ///< processor time of all reachable nodes
  std::int64_t peak_memory_bytes = 0;  ///< of one worker
  std::int64_t response_bytes = 0;     ///< of all reachable nodes, in the database
  bool pareto = false;                 ///< no other row is both cheaper and more exact
};

struct TradeReport {
  std::int64_t reachable = 0;         ///< nodes
  std::vector<std::int32_t> vertex;   ///< sampled ones
  double reference_resolution = 0.0;  ///< [-]
  int reference_depths = 0;
  double budget_resolution = 0.0;  ///< [-] that the scene's accuracy budget leads to
  double force_relative = 0.0;     ///< [-] that budget
  std::vector<AccuracyTradeRow> row;
  std::vector<std::string> notes;
};

/// Presses the first tool of the scene. Errors are against responses on meshes that are
/// finer than all others, nonlinear at every depth where the scene is nonlinear. An
/// interpolated response is its vertex's linear one times the ratio that the other
/// sampled vertices have. @throws as build(); NumericalError if no vertex has a
/// reference.
[[nodiscard]] TradeReport trade(const Scene& scene, const AccuracyTradeOptions& options,
                                Progress& progress);

/// One line per row, with a header.
[[nodiscard]] std::string trade_csv(const TradeReport& report);

/// Error over processor time: SVG.
[[nodiscard]] std::string trade_picture(const TradeReport& report);

}  // namespace palpate
