// The forms of a trade that stay: CSV and picture.
#include <algorithm>

#include <fmt/format.h>

#include "formats/report/axis_ticks.h"
#include "formats/report/log_plot.h"
#include "precompute/build/accuracy_trade.h"

namespace palpate {
namespace {

// Whether a way is much more exact than all that are cheaper: labels of others would
// cover each other.
bool is_a_step(const TradeReport& report, const AccuracyTradeRow& row) {
  return row.pareto && std::none_of(report.row.begin(), report.row.end(),
                                    [&](const AccuracyTradeRow& other) {
                                      return other.compared > 0 &&
                                             other.cpu_seconds < row.cpu_seconds &&
                                             other.error_rms < 1.1 * row.error_rms;
                                    });
}

}  // namespace

std::string trade_csv(const TradeReport& report) {
  std::string csv =
      "contact_resolution,method,solve,depths,compared,error_rms,error_largest,"
      "cpu_seconds,cpu_seconds_per_node,peak_memory_bytes,response_bytes,pareto\n";
  for (const AccuracyTradeRow& row : report.row) {
    csv += fmt::format("{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{:d}\n",
                       row.resolution, row.nonlinear ? "nonlinear" : "linear",
                       row.interpolated ? "interpolated" : "all", row.depths,
                       row.compared, row.error_rms, row.error_largest, row.cpu_seconds,
                       row.cpu_seconds / static_cast<double>(report.reachable),
                       row.peak_memory_bytes, row.response_bytes, row.pareto);
  }
  return csv;
}

std::string trade_picture(const TradeReport& report) {
  LogPicture picture{
      .title = "Error of force over time",
      .subtitle = fmt::format(
          "{} nodes; {} of them pressed, against resolution {}; labels: elements per "
          "contact radius / depths",
          report.reachable, report.vertex.size(),
          short_number(report.reference_resolution)),
      .x_name = "processor time of all nodes [s]",
      .y_name = "rms error",
      .series = {{.name = "linear", .point = {}},
                 {.name = "nonlinear, interpolated", .point = {}},
                 {.name = "nonlinear, all solved", .point = {}}},
      .level = report.force_relative,
      .level_name = "the scene's budget"};
  for (const AccuracyTradeRow& row : report.row) {
    if (row.compared > 0) {
      const std::size_t series = !row.nonlinear ? 0 : row.interpolated ? 1 : 2;
      picture.series[series].point.push_back(
          {.x = row.cpu_seconds,
           .y = row.error_rms,
           .radius_px = 3.0 + row.resolution,
           .label = is_a_step(report, row)
                        ? fmt::format("{}/{}", short_number(row.resolution), row.depths)
                        : ""});
    }
  }
  std::erase_if(picture.series, [](const LogSeries& series) {
    return series.point.empty();
  });
  return log_picture(picture);
}

}  // namespace palpate
