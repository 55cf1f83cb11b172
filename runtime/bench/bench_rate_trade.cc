#include "runtime/bench/bench_rate_trade.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/report/log_plot.h"
#include "runtime/bench/bench_table1.h"

namespace palpate {
namespace {

constexpr double kPokedStiffness = 100.0;  // [N/m]

bool divides(double slow_hz, double fast_hz) {
  const double ticks = fast_hz / slow_hz;
  return ticks >= 1.0 && std::abs(ticks - std::round(ticks)) < 1e-9;
}

double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Error, energy and processor time of pokes: all but the stiffness of a row.
void poke(const RateTradeOptions& o, RateTradeRow& row) {
  RenderedWall wall(row.model, row.wall, kPokedStiffness);
  const double dt = 1.0 / row.fast_hz;
  const long every = std::lround(row.fast_hz / row.slow_hz);
  const long ticks = std::lround(o.pokes / o.poke_hz * row.fast_hz);
  double error2 = 0.0;
  double force2 = 0.0;
  const double begin_s = processor_s();
  for (long n = 0; n <= ticks; ++n) {
    const double s =
        std::sin(std::numbers::pi * o.poke_hz * static_cast<double>(n) * dt);
    const double x = n == ticks ? 0.0 : o.poke_depth_m * s * s;
    const double rendered = wall.tick(x, dt, n % every == 0);
    const double wanted = wall.true_force_n(x);
    error2 += (rendered - wanted) * (rendered - wanted);
    force2 += wanted * wanted;
    row.created_j = std::max(row.created_j, -wall.work_j());
  }
  row.cpu_s_per_s = (processor_s() - begin_s) / (static_cast<double>(ticks) * dt);
  row.rms_relative_error = std::sqrt(error2 / force2);
  row.net_energy_j = wall.work_j();
}

double stable_stiffness(const RateTradeOptions& o, const TradeDevice& device,
                        const RateTradeRow& row) {
  Table1Options lean;
  lean.fast_hz = row.fast_hz;
  lean.device = device.mass;
  lean.resolution_m = device.resolution_m;
  lean.delay_s = device.delay_s;
  lean.wall = row.wall;
  lean.preload_n = o.preload_n;
  lean.settle_s = o.settle_s;
  lean.watch_s = o.watch_s;
  lean.tolerance = o.tolerance;
  lean.stiffness_max = o.stiffness_max;
  return largest_stable_stiffness(lean, row.model, row.slow_hz);
}

// Rates, wall and model of every row, without what is measured.
std::vector<RateTradeRow> combinations(const RateTradeOptions& o) {
  std::vector<RateTradeRow> rows;
  for (const WallShape wall : o.walls) {
    for (const LocalModel model : o.models) {
      for (const double fast : o.fast_hz) {
        for (const double slow : o.slow_hz) {
          if (divides(slow, fast)) {
            RateTradeRow& row = rows.emplace_back();
            row.wall = wall;
            row.model = model;
            row.fast_hz = fast;
            row.slow_hz = slow;
          }
        }
      }
    }
  }
  return rows;
}

}  // namespace

std::vector<TradeDevice> trade_devices() {
  return {{"pencat-like", {}, 0.0, 0.0},
          {"falcon-like",
           {.mass_kg = 0.2, .damping_n_s_per_m = 3.0, .load_n_per_m = 0.0},
           5e-5,
           1e-3}};
}

std::vector<RateTradeRow> run_trade(const RateTradeOptions& options) {
  std::vector<RateTradeRow> poked = combinations(options);
  if (poked.empty() || options.devices.empty()) {
    throw InputError("bench trade: no slow rate divides a fast rate");
  }
  for (RateTradeRow& row : poked) {
    poke(options, row);
  }
  std::vector<RateTradeRow> rows;
  for (const TradeDevice& device : options.devices) {
    for (RateTradeRow row : poked) {
      row.device = device.name;
      row.stable_stiffness_n_per_m = stable_stiffness(options, device, row);
      rows.push_back(row);
    }
  }
  return rows;
}

std::string table_text(const std::vector<RateTradeRow>& rows) {
  std::string text = fmt::format(
      "{:<12} {:<10} {:<16} {:>7} {:>7} {:>12} {:>11} {:>12} {:>11} {:>9}\n", "device",
      "wall", "model", "fast Hz", "slow Hz", "stable N/m", "rms error", "net energy J",
      "created J", "cpu");
  for (const RateTradeRow& row : rows) {
    text += fmt::format(
        "{:<12} {:<10} {:<16} {:>7} {:>7} {:>12.1f} {:>9.3f} % {:>12.3e} {:>11.1e} "
        "{:>7.4f} %\n",
        row.device, name(row.wall), name(row.model), row.fast_hz, row.slow_hz,
        row.stable_stiffness_n_per_m, 100.0 * row.rms_relative_error, row.net_energy_j,
        row.created_j, 100.0 * row.cpu_s_per_s);
  }
  return text;
}

std::string table_csv(const std::vector<RateTradeRow>& rows) {
  std::string text =
      "device,wall,model,fast_hz,slow_hz,stable_stiffness_n_per_m,rms_relative_error,"
      "net_energy_j,created_j,cpu_s_per_s\n";
  for (const RateTradeRow& row : rows) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", row.device, name(row.wall),
                        name(row.model), row.fast_hz, row.slow_hz,
                        row.stable_stiffness_n_per_m, row.rms_relative_error,
                        row.net_energy_j, row.created_j, row.cpu_s_per_s);
  }
  return text;
}

std::string to_json(const std::vector<RateTradeRow>& rows) {
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  for (const RateTradeRow& row : rows) {
    json["rows"].push_back({{"device", row.device},
                            {"wall", name(row.wall)},
                            {"model", name(row.model)},
                            {"fast_hz", row.fast_hz},
                            {"slow_hz", row.slow_hz},
                            {"stable_stiffness_n_per_m", row.stable_stiffness_n_per_m},
                            {"rms_relative_error", row.rms_relative_error},
                            {"net_energy_j", row.net_energy_j},
                            {"created_j", row.created_j},
                            {"cpu_s_per_s", row.cpu_s_per_s}});
  }
  return json_text(json);
}

std::string trade_picture(const std::vector<RateTradeRow>& rows, WallShape wall) {
  LogPicture picture;
  picture.x_name = "slow rate [Hz]";
  picture.y_name = "largest stable stiffness [N/m]";
  double fastest = 0.0;
  for (const RateTradeRow& row : rows) {
    fastest = std::max(fastest, row.fast_hz);
  }
  for (const RateTradeRow& row : rows) {
    if (row.wall != wall || row.fast_hz != fastest ||
        row.device != rows.front().device) {
      continue;
    }
    if (picture.series.empty() || picture.series.back().name != name(row.model)) {
      picture.series.push_back({std::string(name(row.model)), {}, true});
    }
    picture.series.back().point.push_back({row.slow_hz, row.stable_stiffness_n_per_m});
  }
  picture.title = fmt::format("Stiffness that stays stable, {} wall", name(wall));
  picture.subtitle = rows.empty() ? ""
                                  : fmt::format("{} device, fast rate {} Hz",
                                                rows.front().device, fastest);
  return log_picture(picture);
}

}  // namespace palpate
