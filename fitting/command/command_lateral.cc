// palpate-fit lateral: lateral loops in, tangential stiffness, friction and presliding
// out.
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fitting/command/commands.h"
#include "fitting/command/estimate_text.h"
#include "fitting/command/lateral_file.h"
#include "fitting/command/machine_options.h"
#include "fitting/lateral/lateral_json.h"
#include "fitting/lateral/lateral_scene.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

struct LateralOptions {
  std::vector<std::string> files;
  MeasurementColumns given;
  MeasurementColumn normal, across, across_force;
  bool ignore_header_units = false;
  std::vector<double> normal_n, depth_mm;  // one of each run
  MachineOptions machine;
  std::string scene;  // file for its keys; empty: none
  bool json = false;

  [[nodiscard]] HeaderUnits header_units() const {
    return ignore_header_units ? HeaderUnits::kIgnored : HeaderUnits::kMustAgree;
  }
};

// Motions along a line together, motions in the plane one by one.
struct LateralReport {
  std::optional<LateralFit> line;
  std::vector<PlaneFit> plane;
  std::vector<std::string> notes;

  [[nodiscard]] const IntervalEstimate& friction() const {
    return line ? line->better.friction : plane.front().friction;
  }
  [[nodiscard]] const IntervalEstimate& presliding_m() const {
    return line ? line->better.presliding_m : plane.front().presliding_m;
  }
};

LateralReport fit_runs(const std::vector<LateralRun>& runs,
                       const FrameCompliance* frame) {
  LateralReport report;
  std::vector<LateralRun> lines;
  for (const LateralRun& run : runs) {
    const LineMotion motion = along_line(run);
    if (run.across_m.empty() || motion.on_line) {
      lines.push_back(motion.run);
    } else {
      report.plane.push_back(fit_plane(run, frame));
    }
    if (motion.on_line) {
      report.notes.push_back(fmt::format(
          "{}: the motion lies on one line, at {:.1f} degrees: the stiffness across it "
          "and their coupling are not determined",
          run.name,
          std::round(motion.direction_rad * 1800.0 / std::numbers::pi) / 10.0 + 0.0));
    }
  }
  if (!lines.empty()) {
    report.line = fit_lateral(lines, frame);
  }
  return report;
}

// One value of each run, or one for all.
void share_out(const std::vector<double>& values, const char* option,
               std::vector<LateralRun>& runs, double LateralRun::*value) {
  if (!values.empty() && values.size() != 1 && values.size() != runs.size()) {
    throw InputError(
        fmt::format("{}: has {} values, must have 1 or one for each of {} runs", option,
                    values.size(), runs.size()));
  }
  for (std::size_t i = 0; !values.empty() && i < runs.size(); ++i) {
    runs[i].*value = values.size() == 1 ? values.front() : values[i];
  }
}

// Across the first direction both columns, in its units.
void take_given_across(LateralOptions& options) {
  if (options.across.column.empty() != options.across_force.column.empty()) {
    throw InputError("--across-column and --across-force-column go together");
  }
  if (options.across.column.empty()) {
    return;
  }
  const auto unit_of = [](const MeasurementColumn& first) {
    return first.unit.empty() ? std::string(kUnitFromHeader) : first.unit;
  };
  options.across.unit = unit_of(options.given.depth);
  options.across_force.unit = unit_of(options.given.force);
  options.given.lateral->across = options.across;
  options.given.lateral->across_force = options.across_force;
}

void take_given_columns(LateralOptions& options) {
  options.given.time = given_time(options.machine);
  options.given.lateral.emplace();
  take_given_across(options);
  options.given.lateral->normal_is_known = !options.normal_n.empty();
  if (options.normal.column.empty()) {
    if (!options.normal.unit.empty()) {
      throw InputError("--normal-force-unit goes with --normal-force-column");
    }
    return;
  }
  if (!options.normal_n.empty()) {
    throw InputError("--normal-force-column and --normal-force-n: tell one of them");
  }
  if (options.normal.unit.empty()) {
    options.normal.unit = kUnitFromHeader;
  }
  options.given.lateral->normal = options.normal;
}

std::vector<LateralRun> all_runs(const std::vector<LateralFile>& files,
                                 const LateralOptions& options) {
  std::vector<LateralRun> runs;
  for (const LateralFile& file : files) {
    runs.insert(runs.end(), file.run.begin(), file.run.end());
  }
  share_out(options.normal_n, "--normal-force-n", runs, &LateralRun::normal_stated_n);
  share_out(options.depth_mm, "--depth-mm", runs, &LateralRun::depth_m);
  for (LateralRun& run : runs) {
    run.depth_m *= 1e-3;
  }
  return runs;
}

nlohmann::ordered_json files_json(const std::vector<LateralFile>& files) {
  auto json = nlohmann::ordered_json::array();
  for (const LateralFile& file : files) {
    json.push_back({{"layout", file.layout},
                    {"displacement_column", file.displacement_column},
                    {"force_column", file.force_column},
                    {"normal_force_column", file.normal_column},
                    {"notes", file.notes}});
  }
  return json;
}

void print_run(const RunFit& run, std::size_t number) {
  const std::string depth = std::isnan(run.depth_m)
                                ? std::string()
                                : fmt::format(", depth {:.4g} m", run.depth_m);
  const std::string normal = std::isnan(run.normal_n)
                                 ? std::string()
                                 : fmt::format(", normal force {:.4g} N", run.normal_n);
  fmt::print("{:<24} {}{}{}: {} samples stick, {} slide, {} closed loops\n",
             fmt::format("run {}", number), run.name, depth, normal, run.samples.sticks,
             run.samples.slides(), run.cycle.size());
  print_estimate("  stiffness k", run.stiffness_n_per_m, "N/m");
  print_estimate("  sliding force", run.slip_force_n, "N");
  print_estimate("  friction mu", run.friction, "");
  print_estimate("  presliding length", run.presliding_m, "m");
  print_estimate("  loss a cycle", run.loss_j, "J");
  print_estimate("  loss by the law", run.modelled_loss_j, "J");
  print_estimate("  drift", run.drift_n, "N");
  fmt::print("{:<24} {:>13.6g} N rms\n", "  residual", run.rms_n);
  for (const std::string& note : run.notes) {
    fmt::print("{:<24} {}\n", "  note", note);
  }
}

void print_laws(const LateralFit& fit) {
  fmt::print("{:<24} {}: residual {:.3g} N rms, of {} {:.3g} N\n", "law",
             law_name(fit.better.law), fit.better.rms_n, law_name(fit.other.law),
             fit.other.rms_n);
  if (!fit.laws_differ()) {
    fmt::print("{:<24} the data do not tell the laws apart (odds below 20)\n", "");
  }
  const IntervalEstimate &k = fit.better.runs.front().stiffness_n_per_m,
                         &other = fit.other.runs.front().stiffness_n_per_m;
  if (k.refused.empty() && other.refused.empty()) {
    fmt::print(
        "{:<24} {} would give k {:.4g} N/m; -2 log of its likelihood over the "
        "first is {:.4g}\n",
        "", law_name(fit.other.law), other.value, fit.deviance);
  }
}

void print_plane(const PlaneFit& fit) {
  fmt::print("{:<24} {}: {}, residual {:.3g} N rms, of the other law {:.3g} N\n",
             "plane motion", fit.name, law_name(fit.law), fit.rms_n, fit.other_rms_n);
  print_estimate("  stiffness k_xx", fit.xx_n_per_m, "N/m");
  print_estimate("  stiffness k_xy", fit.xy_n_per_m, "N/m");
  print_estimate("  stiffness k_yy", fit.yy_n_per_m, "N/m");
  print_estimate("  sliding force", fit.slip_force_n, "N");
  print_estimate("  friction mu", fit.friction, "");
  print_estimate("  presliding length", fit.presliding_m, "m");
}

void print_line_fit(const LateralFit& fit) {
  print_laws(fit);
  print_estimate("friction mu", fit.better.friction, "");
  print_estimate("presliding length", fit.better.presliding_m, "m");
  for (std::size_t i = 0; i < fit.better.runs.size(); ++i) {
    print_run(fit.better.runs[i], i + 1);
  }
  if (fit.better.frictions_differ) {
    fmt::print(
        "{:<24} the runs' friction coefficients differ beyond their errors; each "
        "keeps its own\n",
        "warning");
  }
}

void print_lateral(const std::vector<LateralFile>& files, const LateralReport& report) {
  for (const LateralFile& file : files) {
    fmt::print("{:<24} {}, displacement \"{}\", force \"{}\"{}\n", "file", file.layout,
               file.displacement_column, file.force_column,
               file.normal_column.empty()
                   ? std::string()
                   : fmt::format(", normal force \"{}\"", file.normal_column));
    for (const std::string& note : file.notes) {
      fmt::print("{:<24} {}\n", "  note", note);
    }
  }
  fmt::print("{:<24} +- is one standard deviation, [] holds 95 %\n", "fit");
  if (report.line) {
    print_line_fit(*report.line);
  }
  for (const PlaneFit& fit : report.plane) {
    print_plane(fit);
  }
  for (const std::string& note : report.notes) {
    fmt::print("{:<24} {}\n", "not separated", note);
  }
}

void print_lateral_json(const std::vector<LateralFile>& files,
                        const LateralReport& report) {
  nlohmann::ordered_json json;
  json["files"] = files_json(files);
  if (report.line) {
    json.update(to_json(*report.line));
  }
  json["plane"] = nlohmann::ordered_json::array();
  for (const PlaneFit& fit : report.plane) {
    json["plane"].push_back(to_json(fit));
  }
  json["notes"] = report.notes;
  fmt::print("{}\n", json_text(json));
}

void run_lateral(LateralOptions& options) {
  if (!options.machine.cycle.empty()) {
    throw InputError("--cycle: lateral fits all cycles of its files together");
  }
  take_given_columns(options);
  std::vector<LateralFile> files;
  for (const std::string& file : options.files) {
    files.push_back(read_lateral_file(file, options.given, options.header_units()));
  }
  const auto frame = frame_of(options.machine, [&](const std::string& file) {
    const LateralRun run =
        read_lateral_file(file, options.given, options.header_units()).run.front();
    return Measurement{.depth_m = run.displacement_m, .force_n = run.force_n};
  });
  const std::vector<LateralRun> runs = all_runs(files, options);
  try {
    const LateralReport report = fit_runs(runs, frame ? &frame->frame : nullptr);
    if (!options.scene.empty()) {
      write_scene_part(lateral_scene(report.friction(), report.presliding_m()),
                       options.scene);
    }
    options.json ? print_lateral_json(files, report) : print_lateral(files, report);
  } catch (const InputError& error) {
    const std::string message = error.what();
    throw InputError(options.files.size() == 1 && message.starts_with(options.files[0])
                         ? message
                         : fmt::format("{}: {}", joined_names(options.files), message));
  }
}

void add_column_options(Command command, LateralOptions& options) {
  const std::string by_header = "name or number; default: as the header tells",
                    lengths = "m, cm, mm, um, nm, in; default: the header's",
                    forces =
                        "kN, N, cN, mN, uN, nN, gf, kgf, lbf; default: the header's";
  command.add_option("--displacement-column", options.given.depth.column,
                     "lateral displacement: " + by_header);
  command.add_option("--displacement-unit", options.given.depth.unit, lengths);
  command.add_option("--force-column", options.given.force.column,
                     "tangential force: " + by_header);
  command.add_option("--force-unit", options.given.force.unit, forces);
  command.add_option("--normal-force-column", options.normal.column,
                     "force that presses: " + by_header);
  command.add_option("--normal-force-unit", options.normal.unit, forces);
  command.add_option("--across-column", options.across.column,
                     "displacement across the first, of a motion in two directions");
  command.add_option("--across-force-column", options.across_force.column,
                     "tangential force across the first");
  command.add_flag("--ignore-header-units", options.ignore_header_units,
                   "trust the flags where the header states other units");
}

}  // namespace

void add_lateral_command(Command app) {
  auto options = std::make_shared<LateralOptions>();
  Command command = app.add_subcommand(
      "lateral", "Fit tangential stiffness, friction and presliding of lateral loops.");
  command
      .add_option("FILE", options->files,
                  "loops of tangential force against lateral displacement at a held "
                  "depth; layouts as of curve")
      .required();
  add_column_options(command, *options);
  command
      .add_option("--normal-force-n", options->normal_n,
                  "constant normal force in place of a column: one, or one of each run")
      .separated_by(',');
  command
      .add_option("--depth-mm", options->depth_mm,
                  "depth at which it was held, for the report: one, or one of each run")
      .separated_by(',');
  command.add_option("--scene", options->scene,
                     "file for friction and presliding of a scene's tool (TOML)");
  add_machine_options(command, options->machine);
  command.add_flag("--json", options->json, "report for programs");
  command.callback([options] {
    run_lateral(*options);
  });
}

}  // namespace palpate
