#include "tests/bench/runtime/bench_potential.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "tests/bench/runtime/field_walk.h"

namespace palpate {
namespace {

constexpr double kPreslidingM = 5e-4;
constexpr std::array<LocalModel, 3> kModels{
    LocalModel::kElement, LocalModel::kPotential, LocalModel::kFacets};

PotentialBenchRow row_of(const FieldAccount& account) {
  PotentialBenchRow row;
  row.contact_ticks = account.contact_ticks;
  row.starved_ticks = account.starved_ticks;
  row.interventions = account.interventions;
  row.created_j = -account.lowest_work_j;
  row.felt_created_j = -account.lowest_felt_j;
  row.work_j = account.work_j;
  if (account.normal_max_n > 0.0) {
    row.normal_error_max = account.error_max_n / account.normal_max_n;
    row.normal_error_rms =
        std::sqrt(account.error_square_n2 / account.normal_square_n2);
  }
  row.shift_max_m = account.shift_max_m;
  return row;
}

AngleHistogram histogram(std::vector<double> angle_rad) {
  AngleHistogram histogram;
  if (angle_rad.empty()) {
    return histogram;
  }
  std::sort(angle_rad.begin(), angle_rad.end());
  const auto degrees = [&](double fraction) {
    const auto last = static_cast<double>(angle_rad.size() - 1);
    return angle_rad[static_cast<std::size_t>(fraction * last)] * 180.0 /
           std::numbers::pi;
  };
  histogram.median_deg = degrees(0.5);
  histogram.p95_deg = degrees(0.95);
  for (const double angle : angle_rad) {
    const auto bin = std::lower_bound(kAngleEdgesDeg.begin(), kAngleEdgesDeg.end() - 1,
                                      angle * 180.0 / std::numbers::pi);
    ++histogram.count[static_cast<std::size_t>(bin - kAngleEdgesDeg.begin())];
  }
  return histogram;
}

void render_both(FieldWalk& walk, const std::string& body, double contrast,
                 const std::vector<double>& frictions, PotentialBenchReport& report,
                 bool angles) {
  for (const double friction : frictions) {
    set_friction(walk, friction, kPreslidingM);
    for (const LocalModel model : kModels) {
      FieldAccount account = render(walk, model);
      PotentialBenchRow row = row_of(account);
      row.body = body;
      row.contrast = contrast;
      row.friction = friction;
      row.model = model;
      report.rows.push_back(row);
      if (angles && model == LocalModel::kPotential && friction == frictions.front()) {
        report.angle = histogram(std::move(account.angle_rad));
      }
    }
  }
}

}  // namespace

PotentialBenchReport run_potential_bench(const PotentialBenchOptions& options) {
  PotentialBenchReport report;
  for (const double contrast : options.contrasts) {
    BenchBodyOptions shape;
    shape.wave_m = 0.004;
    shape.contrast = contrast;
    shape.tilt_rad = 0.2;
    shape.touch_offset_m = 2e-4;
    FieldWalk walk =
        walk_over(make_bench_body(shape), {.ticks = options.ticks, .lift_m = 0.005},
                  options.ticks_per_slow);
    render_both(walk, "waves", contrast, options.frictions, report, false);
  }
  if (!options.database.empty()) {
    const ResponseDatabase database = read_database(options.database);
    const ResponseTable& table = find_tool(database, options.tool);
    FieldWalk walk =
        walk_over(database, table,
                  {.ticks = options.ticks, .ticks_per_slow = options.ticks_per_slow});
    render_both(walk, options.database.filename().string(), 1.0, options.frictions,
                report, true);
  }
  return report;
}

std::string table_text(const PotentialBenchReport& report) {
  std::string text = fmt::format(
      "{:<12} {:>8} {:>5} {:<10} {:>10} {:>9} {:>12} {:>11} {:>11} {:>11} {:>10}\n",
      "body", "contrast", "mu", "model", "created J", "felt J", "interventions",
      "normal max", "normal rms", "shift mm", "starved");
  for (const PotentialBenchRow& row : report.rows) {
    const auto ticks =
        static_cast<double>(std::max<std::int64_t>(1, row.contact_ticks));
    text += fmt::format(
        "{:<12} {:>8} {:>5} {:<10} {:>10.1e} {:>9.1e} {:>11.4f} % {:>9.2e} {:>11.2e} "
        "{:>11.4f} {:>8.3f} %\n",
        row.body, row.contrast, row.friction, name(row.model), row.created_j,
        row.felt_created_j, 100.0 * static_cast<double>(row.interventions) / ticks,
        row.normal_error_max, row.normal_error_rms, 1e3 * row.shift_max_m,
        100.0 * static_cast<double>(row.starved_ticks) / ticks);
  }
  if (report.angle.p95_deg > 0.0) {
    text += fmt::format(
        "Angle of -grad U to the stored direction: median {:.2f} deg, 95 % below "
        "{:.2f} deg\n",
        report.angle.median_deg, report.angle.p95_deg);
    for (std::size_t i = 0; i < kAngleEdgesDeg.size(); ++i) {
      text += fmt::format("  up to {:>3} deg {:>9}\n", kAngleEdgesDeg[i],
                          report.angle.count[i]);
    }
  }
  return text;
}

std::string to_json(const PotentialBenchReport& report) {
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  for (const PotentialBenchRow& row : report.rows) {
    json["rows"].push_back({{"body", row.body},
                            {"contrast", row.contrast},
                            {"friction", row.friction},
                            {"model", name(row.model)},
                            {"contact_ticks", row.contact_ticks},
                            {"starved_ticks", row.starved_ticks},
                            {"interventions", row.interventions},
                            {"energy_created_j", row.created_j},
                            {"felt_created_j", row.felt_created_j},
                            {"work_j", row.work_j},
                            {"normal_error_max", row.normal_error_max},
                            {"normal_error_rms", row.normal_error_rms},
                            {"rest_offset_max_m", row.shift_max_m}});
  }
  json["angle"] = {{"upper_edge_deg", kAngleEdgesDeg},
                   {"count", report.angle.count},
                   {"median_deg", report.angle.median_deg},
                   {"p95_deg", report.angle.p95_deg}};
  return json_text(json);
}

}  // namespace palpate
