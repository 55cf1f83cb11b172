#include "fitting/session/mean_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr double kSteps = 25.0;

using Runs = std::vector<const RunResult*>;
using PointRuns = std::map<std::string, Runs>;
using Specimens = std::map<std::string, PointRuns>;

bool can_be_averaged(const RunResult& run) {
  return run.best() != nullptr && run.rating.verdict != Verdict::kSkip &&
         !run.contact.has(FitFlag::kAdhesion);
}

bool depth_is_known(const RunResult& run) {
  return can_be_averaged(run) && !run.contact.has(FitFlag::kAlreadyInContact) &&
         !run.contact.has(FitFlag::kContactPointNotIdentified);
}

bool begins_in_contact(const RunResult& run) {
  return can_be_averaged(run) && run.contact.has(FitFlag::kAlreadyInContact);
}

Specimens sorted(const BatchReport& report, bool (*takes)(const RunResult&)) {
  Specimens specimens;
  for (const RunResult& run : report.runs) {
    if (takes(run)) {
      specimens[run.specimen][run.point].push_back(&run);
    }
  }
  return specimens;
}

// Every point a specimen of its own.
Specimens one_by_one(const PointRuns& points) {
  Specimens specimens;
  for (const auto& [name, runs] : points) {
    specimens[name][name] = runs;
  }
  return specimens;
}

std::vector<double> forces_n(const Runs& runs, double depth_m) {
  std::vector<double> forces;
  for (const RunResult* run : runs) {
    forces.push_back(family_point(*run->best(), depth_m).force);
  }
  return forces;
}

RandomEffects effects_at(const Specimens& specimens, double depth_m) {
  std::vector<std::vector<std::vector<double>>> y;
  for (const auto& [specimen, points] : specimens) {
    auto& of_points = y.emplace_back();
    for (const auto& [point, runs] : points) {
      of_points.push_back(forces_n(runs, depth_m));
    }
  }
  return random_effects(y);
}

enum class Level { kSpecimens, kPoints, kRepeats };

// What the model calls specimens are points or repeats; each scatter under its name.
void rename(Level level, RandomEffects& e) {
  if (level == Level::kPoints) {
    e.point_sd = e.specimen_sd;
    e.points = e.specimens;
  } else if (level == Level::kRepeats) {
    e.repeat_sd = e.specimen_sd;
    e.point_sd = RandomEffects::kUnknown;
    e.points = 1;
  }
  if (level != Level::kSpecimens) {
    e.specimen_sd = RandomEffects::kUnknown;
    e.specimens = 1;
  }
}

MeanCurve curve_of(std::string name, const Specimens& specimens, Level level) {
  MeanCurve curve;
  curve.name = std::move(name);
  double shallowest = std::numeric_limits<double>::infinity();
  for (const auto& [specimen, points] : specimens) {
    for (const auto& [point, runs] : points) {
      curve.runs += runs.size();
      for (const RunResult* run : runs) {
        shallowest = std::min(shallowest, run->best()->depth_max_m);
      }
    }
  }
  for (const double depth : depth_grid_m(shallowest)) {
    if (depth > 0.0) {
      curve.depth_m.push_back(depth);
      curve.force_n.push_back(effects_at(specimens, depth));
      rename(level, curve.force_n.back());
    }
  }
  return curve;
}

void append_points(const std::string& specimen, const PointRuns& points,
                   std::vector<MeanCurve>& curves) {
  for (const auto& [point, runs] : points) {
    if (runs.size() < 2) {
      continue;
    }
    PointRuns repeats;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      repeats[fmt::format("{:06}", k)] = {runs[k]};
    }
    curves.push_back(curve_of(
        specimen.empty() ? fmt::format("point {}", point)
                         : fmt::format("point {} of specimen {}", point, specimen),
        one_by_one(repeats), Level::kRepeats));
  }
}

// A point without a specimen is one of its own.
void name_the_unnamed(Specimens& specimens) {
  const auto unnamed = specimens.find("");
  if (unnamed == specimens.end()) {
    return;
  }
  const PointRuns points = unnamed->second;
  specimens.erase(unnamed);
  for (const auto& [point, runs] : points) {
    specimens["point " + point][point] = runs;
  }
}

std::vector<MeanCurve> mean_curves_of(Specimens specimens) {
  std::vector<MeanCurve> curves;
  const auto points_of = [&](const std::string& name, const std::string& specimen,
                             const PointRuns& points) {
    if (points.size() > 1) {
      curves.push_back(curve_of(name, one_by_one(points), Level::kPoints));
    }
    append_points(specimen, points, curves);
  };
  if (specimens.size() == 1) {
    const auto& [specimen, points] = *specimens.begin();
    points_of(specimen.empty() ? "all" : "specimen " + specimen, specimen, points);
    return curves;
  }
  name_the_unnamed(specimens);
  curves.push_back(curve_of("all", specimens, Level::kSpecimens));
  for (const auto& [specimen, points] : specimens) {
    points_of("specimen " + specimen, specimen, points);
  }
  return curves;
}

}  // namespace

std::vector<double> depth_grid_m(double largest_m) {
  const double least = largest_m / kSteps;
  double step = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * step <= least * (1.0 + 1e-9)) {
      step *= factor;
      break;
    }
  }
  std::vector<double> grid;
  const auto count = static_cast<int>(std::floor(largest_m / step * (1.0 + 1e-9)));
  for (int k = 0; k <= count; ++k) {
    grid.push_back(step * k);
  }
  return grid;
}

MeanCurves mean_curves(const BatchReport& report) {
  const auto count = [&](bool (*takes)(const RunResult&)) {
    return static_cast<std::size_t>(
        std::count_if(report.runs.begin(), report.runs.end(), takes));
  };
  MeanCurves means;
  means.from_first_sample = count(depth_is_known) < 2 && count(begins_in_contact) > 1;
  const auto takes = means.from_first_sample ? begins_in_contact : depth_is_known;
  if (report.runs.size() < 2) {
    return means;
  }
  means.left_out = report.runs.size() - count(takes);
  if (count(takes) > 1) {
    means.curves = mean_curves_of(sorted(report, takes));
  }
  return means;
}

std::string left_out_text(const MeanCurves& means) {
  std::string text;
  if (means.left_out > 0) {
    text = fmt::format(
        "{} in no mean: skipped, contact point not known, or sticking. ",
        means.left_out == 1 ? "1 run is" : fmt::format("{} runs are", means.left_out));
  }
  if (means.from_first_sample) {
    text +=
        "The runs begin in contact: depths of the means count from the first sample. ";
  }
  return text;
}

}  // namespace palpate
