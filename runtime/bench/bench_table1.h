// `palpate-run bench table1`: the paper's Table 1 on the virtual PenCat.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "runtime/account/local_model.h"
#include "runtime/bench/axis_device.h"
#include "runtime/bench/rendered_wall.h"

namespace palpate {

struct Table1Options {
  /// Divide fast_hz; the paper's, and slower ones.
  std::vector<double> rates_hz{2000, 1000, 500, 250, 200, 100, 50, 20, 10};
  double fast_hz = 2000.0;
  VirtualDeviceOptions device;
  double resolution_m = 0.0;  ///< [m] >= 0 of the measured position; 0: exact
  double delay_s = 0.0;       ///< [s] >= 0 until a command acts, in whole ticks
  WallShape wall = WallShape::kNonlinear;
  WallRelaxation relaxation = {};  ///< at most kMemoryTerms
  /// [N] into the wall, constant. The paper's 1 N leans on the wall's linear part, 0.1
  /// N on the quadratic one.
  double preload_n = 1.0;
  double kick_m_per_s = 0.005;    ///< [m/s] the disturbance
  double hand_n_s_per_m = 50.0;   ///< [N s/m] a hand damps the device while it settles
  double settle_s = 4.0;          ///< [s] then the hand lets go
  double watch_s = 10.0;          ///< [s] after it
  double tolerance = 0.002;       ///< [-] relative width at which the bisection ends
  double stiffness_max = 3000.0;  ///< [N/m] search ends here
};

struct Table1Column {
  LocalModel model = LocalModel::kSingle;
  std::vector<double> stiffness_n_per_m;  ///< largest stable, one per rate
};

struct Table1Report {
  std::vector<double> rates_hz;
  std::vector<Table1Column> columns;  ///< every local model
  double preload_n = 0.0;
  std::string wall;  ///< "nonlinear wall", "linear wall that relaxes"
};

/// One column of the paper's table, at 2000, 1000, 500, 250, 200, 100 Hz [N/m].
struct PaperColumn {
  const char* name;
  std::array<double, 6> stiffness_n_per_m;
};
constexpr std::array<double, 6> kPaperRatesHz{2000, 1000, 500, 250, 200, 100};
constexpr std::array<PaperColumn, 3> kPaperTable1{
    {{"single", {170, 120, 93, 63, 57, 38}},
     {"linear-interpolation", {170, 160, 127, 110, 104, 85}},
     {"passive", {212, 212, 212, 212, 212, 212}}}};

/// Whether a small disturbance of the device leaning on the wall dies out. The preload
/// pushes the device from the surface into the wall while a hand damps it. The hand
/// lets go, and the device is kicked. The device's range of movement in the last
/// quarter of the watch is compared with that in the first.
[[nodiscard]] bool wall_is_stable(const Table1Options& options, LocalModel model,
                                  double slow_hz, double stiffness_n_per_m);

/// Largest k below which every tried k was stable: raised by 5 % from 5 N/m until the
/// first limit cycle, then bisected.
[[nodiscard]] double largest_stable_stiffness(const Table1Options& options,
                                              LocalModel model, double slow_hz);

/// @throws InputError if a rate does not divide fast_hz, or a wall cannot relax so.
[[nodiscard]] Table1Report run_table1(const Table1Options& options);

[[nodiscard]] std::string table_text(const Table1Report& report);
[[nodiscard]] std::string table_csv(const Table1Report& report);
[[nodiscard]] std::string to_json(const Table1Report& report);

}  // namespace palpate
