// `palpate-run bench trade`: what rates and local model buy, in stability, truth,
// energy and processor time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "runtime/account/local_model.h"
#include "runtime/bench/axis_device.h"
#include "runtime/bench/rendered_wall.h"

namespace palpate {

/// A device on one axis that leans on the walls.
struct TradeDevice {
  std::string_view name;
  VirtualDeviceOptions mass;
  double resolution_m = 0.0;  ///< [m] of the measured position; 0: exact
  double delay_s = 0.0;       ///< [s] until a command acts
};

/// The virtual PenCat, and one like the Falcon: 50 um at the tool, a command acts one
/// USB frame of 1 ms later. Its mass and damping are assumed: 0.2 kg, 3 N s/m.
[[nodiscard]] std::vector<TradeDevice> trade_devices();

struct RateTradeOptions {
  std::vector<TradeDevice> devices = trade_devices();
  std::vector<WallShape> walls{kWallShapes.begin(), kWallShapes.end()};
  std::vector<LocalModel> models{kLocalModels.begin(), kLocalModels.end()};
  std::vector<double> fast_hz{500, 1000, 2000, 4000};
  std::vector<double> slow_hz{10, 20, 50, 100, 500, 2000};  ///< those that divide
  double preload_n = 0.1;          ///< [N] leans on the nonlinear walls' quadratic part
  double settle_s = 2.0;           ///< [s] as in bench table1
  double watch_s = 4.0;            ///< [s] likewise
  double tolerance = 0.01;         ///< [-] of the stiffness
  double stiffness_max = 20000.0;  ///< [N/m] search ends here
  double poke_depth_m = 0.01;      ///< [m] of the pokes for error and energy
  double poke_hz = 2.0;            ///< [Hz]
  int pokes = 4;
};

struct RateTradeRow {
  std::string_view device;
  WallShape wall = WallShape::kLinear;
  LocalModel model = LocalModel::kSingle;
  double fast_hz = 0.0;
  double slow_hz = 0.0;
  double stable_stiffness_n_per_m = 0.0;
  double rms_relative_error = 0.0;  ///< [-] of the pokes' force
  double net_energy_j = 0.0;        ///< [J] put in over all pokes; < 0: created
  double created_j = 0.0;           ///< [J] >= 0, most that was ever given away
  double cpu_s_per_s = 0.0;  ///< [-] processor time of fast process and slow turn
};

/// Every combination whose slow rate divides the fast one. Pokes do not depend on the
/// device: x = depth sin^2(pi f t) into a wall of 100 N/m.
/// @throws InputError if there is none.
[[nodiscard]] std::vector<RateTradeRow> run_trade(const RateTradeOptions& options);

[[nodiscard]] std::string table_text(const std::vector<RateTradeRow>& rows);
[[nodiscard]] std::string table_csv(const std::vector<RateTradeRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<RateTradeRow>& rows);

/// Largest stable stiffness over the slow rate, a line per model, as SVG. The picture
/// is of the first device, the given wall and the fastest rate in the rows.
[[nodiscard]] std::string trade_picture(const std::vector<RateTradeRow>& rows,
                                        WallShape wall);

}  // namespace palpate
