// The path of a contact that is moved sideways: its samples, where the motion turned,
// and the normal force along it.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace palpate {

/// What one run of a lateral test measured, in SI units and file order.
struct LateralRun {
  std::string name = {};               ///< for the report: the file
  std::vector<double> displacement_m;  ///< (n) lateral
  std::vector<double> force_n;         ///< (n) tangential
  std::vector<double> time_s = {};     ///< (n), or empty
  std::vector<double> normal_n = {};   ///< (n), or empty
  /// (n), or empty: displacement and force across the first, of a plane motion
  std::vector<double> across_m = {}, across_n = {};
  /// [N] a constant normal force in place of a column; NaN: none is known
  double normal_stated_n = std::numeric_limits<double>::quiet_NaN();
  /// [m] depth at which it was held; NaN: not known
  double depth_m = std::numeric_limits<double>::quiet_NaN();
};

/// A place where the motion turns, mostly between samples. It lies where the lines
/// through the samples before and behind meet, if the speed is steady there. Else it is
/// the top of the parabola through the extreme sample and its neighbours.
struct LateralTurn {
  std::size_t after = 0;  ///< first sample behind it
  double place_m = 0.0;
};

/// Samples in contact. The force is positive where it resists a motion to larger
/// displacements.
struct LateralPath {
  std::vector<double> displacement_m;  ///< (n) [m] as measured
  std::vector<double> force_n;         ///< (n) [N]
  std::vector<double> normal_share;    ///< (n) [-] normal force over its mean
  std::vector<double> clock;           ///< (n) [-] 0 to 1
  std::vector<std::size_t> fitted;     ///< samples that move, and those before motion
  std::vector<LateralTurn> turn;       ///< in order, without the ends of the path
  double normal_n = std::numeric_limits<double>::quiet_NaN();  ///< [N] mean along
                                                               ///< the way; NaN: none
  double travel_m = 0.0;      ///< [m] largest less smallest displacement
  bool force_turned = false;  ///< the force's sign was changed
  std::size_t first = 0;      ///< sample of the run that is the first here
  std::size_t apart = 0;      ///< samples at the ends that were not in contact
};

constexpr std::size_t kLateralSamplesMin = 20;
constexpr double kTurnShareMin = 0.05;    ///< [-] of the travel, that a turn goes back
constexpr double kContactShareMin = 0.5;  ///< [-] of the median normal force
constexpr double kNormalShareMin = 0.2;   ///< [-] of the mean normal force, while held

/// Samples before and after the normal force first and last reaches kContactShareMin of
/// its median are not in contact and are left out. Normal forces may have either sign.
/// Their noise is taken out by means of neighbours.
/// @throws InputError for unequal counts, values that are not finite, fewer than
/// kLateralSamplesMin samples in contact, no motion, and a constant force. InputError
/// too for a normal force that falls below kNormalShareMin of its mean.
[[nodiscard]] LateralPath find_lateral_path(const LateralRun& run);

}  // namespace palpate
