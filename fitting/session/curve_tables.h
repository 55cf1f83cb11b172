// Fitted curves, their means, and cycles of presses as tables for spreadsheets.
#pragma once

#include <string>

#include "fitting/session/batch.h"

namespace palpate {

/// One line per run and depth: force of the chosen family at depths common to all runs
/// (depth_grid_m() of the deepest), standard deviation, 95 % interval. The standard
/// deviation is that of the force's logarithm (log_force_errors), with what the frame's
/// own makes of the depth. The interval is that many times 1.96 in the logarithm.
[[nodiscard]] std::string curves_csv(const BatchReport& report);

/// One line per mean and depth (mean_curves()).
[[nodiscard]] std::string mean_curves_csv(const BatchReport& report);

/// One line per press of the files with several (summarise_cycles()).
[[nodiscard]] std::string cycles_csv(const BatchReport& report);

}  // namespace palpate
