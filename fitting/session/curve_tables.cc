#include "fitting/session/curve_tables.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "fitting/curve/law_error.h"
#include "fitting/numerics/robust_statistics.h"
#include "fitting/session/csv_cell.h"
#include "fitting/session/mean_curves.h"

namespace palpate {
namespace {

std::string cells(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    text += "," + csv_number(value);
  }
  return text;
}

// Standard deviation [-] of the logarithm of the force: the fit's, and the frame's.
double log_sd(const RunResult& run, double depth_m) {
  const FamilyFit& fit = *run.best();
  const double own = log_force_errors(fit, Eigen::VectorXd::Constant(1, depth_m))[0];
  const FamilyPoint at = family_point(fit, depth_m);
  const double frame_m = run.corrections.frame.depth_sd_m * at.force / fit.force_n;
  return std::isfinite(frame_m) ? std::hypot(own, at.slope / at.force * frame_m) : own;
}

std::string curve_rows(const RunResult& run, const std::vector<double>& grid) {
  const FamilyFit& fit = *run.best();
  const std::string begin =
      fmt::format("{},{},{},{},{}", csv_text(run.name), csv_text(run.point),
                  csv_text(run.specimen), verdict_name(run.rating.verdict), fit.family);
  std::string rows;
  for (const double depth : grid) {
    if (depth > fit.depth_max_m) {
      break;
    }
    const double force = family_point(fit, depth).force;
    if (!(force > 0.0)) {
      rows += begin + cells({depth, force, 0.0, force, force}) + "\n";
      continue;
    }
    const double sd = log_sd(run, depth);
    rows += begin +
            cells({depth, force, force * sd, force * std::exp(-kNormal95 * sd),
                   force * std::exp(kNormal95 * sd)}) +
            "\n";
  }
  return rows;
}

}  // namespace

std::string curves_csv(const BatchReport& report) {
  std::string text =
      "run,point,specimen,verdict,family,depth_m,force_n,force_sd_n,lower_95_n,"
      "upper_95_n\n";
  double deepest = 0.0;
  for (const RunResult& run : report.runs) {
    deepest =
        run.best() == nullptr ? deepest : std::max(deepest, run.best()->depth_max_m);
  }
  if (!(deepest > 0.0)) {
    return text;
  }
  const std::vector<double> grid = depth_grid_m(deepest);
  for (const RunResult& run : report.runs) {
    text += run.best() == nullptr ? "" : curve_rows(run, grid);
  }
  return text;
}

std::string mean_curves_csv(const BatchReport& report) {
  std::string text =
      "mean,depth_m,force_n,mean_sd_n,lower_95_n,upper_95_n,degrees_of_freedom,"
      "repeat_sd_n,between_points_sd_n,between_specimens_sd_n,specimens,points,runs\n";
  for (const MeanCurve& mean : mean_curves(report).curves) {
    for (std::size_t i = 0; i < mean.depth_m.size(); ++i) {
      const RandomEffects& e = mean.force_n[i];
      text += csv_text(mean.name) +
              cells({mean.depth_m[i], e.mean, e.mean_sd, e.lower, e.upper,
                     e.degrees_of_freedom, e.repeat_sd, e.point_sd, e.specimen_sd}) +
              fmt::format(",{},{},{}\n", e.specimens, e.points, mean.runs);
    }
  }
  return text;
}

std::string cycles_csv(const BatchReport& report) {
  std::string text =
      "run,press,peak_force_n,press_work_j,loss_j,loss_factor,contact_point_m,"
      "contact_point_sd_m,contact_shift_m,contact_shift_sd_m,bad\n";
  for (const RunResult& run : report.runs) {
    for (std::size_t k = 0; k < run.cycles.size(); ++k) {
      const CycleSummary& c = run.cycles[k];
      text += fmt::format("{},{}", csv_text(run.run_name), k + 1) +
              cells({c.peak_force_n, c.press_work_j, c.loss_j, c.loss_factor,
                     c.contact_point_m, c.contact_point_sd_m, c.contact_shift_m,
                     c.contact_shift_sd_m}) +
              "," + csv_text(c.bad) + "\n";
    }
  }
  return text;
}

}  // namespace palpate
