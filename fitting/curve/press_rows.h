// Samples of a press and its holds as the rows of a fit. Rows are means of neighbours,
// fewer of them where the force changes fast: while the tool moves, and just after it
// stops.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "fitting/curve/joint_relaxation.h"
#include "fitting/curve/press_model.h"

namespace palpate {

struct PressRows {
  /// A hold, from its first row on.
  struct Hold {
    Eigen::Index row = 0;
    double depth = 0.0;  ///< [-] as of `all`
  };

  PressSamples all;  ///< weights by the root of a row's samples, 1 in the mean square
  Eigen::Index press = 0;   ///< rows of the press, ...
  Eigen::Index moving = 0;  ///< ... of those in motion, ...
  Eigen::Index hold = 0;    ///< ... and of press and hold
  std::vector<Hold> holds;  ///< all, rising rows
  double origin_m = 0.0, travel_m = 1.0, force_n = 1.0;  ///< scales of `all`
  double sample_s = 0.0;    ///< [s] mean interval of samples
  double interval_s = 0.0;  ///< [s] mean interval of rows
  double hold_s = 0.0;      ///< [s] the longest hold
  double moving_s = 0.0;    ///< [s] in motion before the last hold
};

/// @param measured at least 2 samples, and of press and of hold at least one.
[[nodiscard]] PressRows rows_of(const PressAndHold& measured);

/// The first `count` of them.
[[nodiscard]] PressSamples first_rows(const PressSamples& all, Eigen::Index count);

}  // namespace palpate
