// palpate-fit insertion: passes of a needle in, ruptures, cutting forces, friction out.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fitting/command/commands.h"
#include "fitting/command/curve_file.h"
#include "fitting/command/estimate_text.h"
#include "fitting/command/machine_options.h"
#include "fitting/curve/parameter_json.h"
#include "fitting/insertion/insertion_json.h"
#include "fitting/insertion/insertion_scene.h"
#include "fitting/insertion/toughness.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/base/units.h"

namespace palpate {
namespace {

struct InsertionOptions {
  std::vector<std::string> files;
  CurveFile read;  // what holds for each file
  bool ignore_header_units = false;
  MachineOptions machine;
  std::optional<double> speed_mm_per_s, edge_width_mm;
  std::string scene;  // file for its keys; empty: none
  bool json = false;
};

struct InsertionRead {
  std::vector<CurveRead> files;
  std::vector<Measurement> samples;
  std::optional<FrameRun> frame;
};

// Depth from time and a constant speed: the column of times is read in place of depths.
void take_time_for_depth(InsertionOptions& options) {
  if (options.machine.time.column.empty()) {
    throw InputError("--speed-mm-per-s needs --time-column");
  }
  if (!options.read.given.depth.column.empty()) {
    throw InputError("--speed-mm-per-s and --depth-column: give one of them");
  }
  if (options.machine.time.unit.empty()) {
    throw InputError("--speed-mm-per-s needs --time-unit: s, ms, us or ns");
  }
  if (options.ignore_header_units == false && options.read.given.force.unit.empty()) {
    throw InputError("--speed-mm-per-s needs --force-unit");
  }
  options.read.given.depth = {options.machine.time.column, "m"};
  options.read.header_units = HeaderUnits::kIgnored;
}

Measurement insertion_samples(const CurveRead& read, const InsertionOptions& options) {
  Measurement samples = read.timed ? *read.timed : read.measurement.samples;
  if (options.speed_mm_per_s) {
    const double second = seconds_per(options.machine.time.unit);
    samples.time_s = samples.depth_m;
    for (std::size_t i = 0; i < samples.depth_m.size(); ++i) {
      samples.time_s[i] *= second;
      samples.depth_m[i] = samples.time_s[i] * *options.speed_mm_per_s * 1e-3;
    }
  }
  return samples;
}

InsertionRead read_insertion(InsertionOptions& options) {
  InsertionRead read;
  options.read.header_units =
      options.ignore_header_units ? HeaderUnits::kIgnored : HeaderUnits::kMustAgree;
  if (options.speed_mm_per_s) {
    take_time_for_depth(options);
  } else {
    options.read.given.time = given_time(options.machine);
  }
  const auto read_one = [&](const std::string& file) {
    CurveFile one = options.read;
    one.file = file;
    return read_curve_file(one);
  };
  read.frame = frame_of(options.machine, [&](const std::string& file) {
    CurveFile plate = options.read;
    plate.file = file;
    plate.press = CurveFile::kNoPress;
    return read_curve_file(plate).measurement.samples;
  });
  for (const std::string& file : options.files) {
    read.files.push_back(read_one(file));
    read.samples.push_back(insertion_samples(read.files.back(), options));
  }
  return read;
}

std::vector<IntervalEstimate> toughness_of_layers(const NeedleFit& fit,
                                                  const InsertionOptions& options) {
  std::vector<IntervalEstimate> found;
  for (const FittedLayer& layer : fit.layers) {
    if (options.edge_width_mm) {
      found.push_back(toughness_of(layer.cutting_n, *options.edge_width_mm * 1e-3));
    }
  }
  return found;
}

void print_insertion_json(const InsertionRead& read, const NeedlePath& path,
                          const NeedleFit& fit,
                          const std::vector<IntervalEstimate>& toughness) {
  nlohmann::ordered_json json;
  json["files"] = nlohmann::ordered_json::array();
  for (const CurveRead& file : read.files) {
    json["files"].push_back({{"layout", file.layout},
                             {"depth_column", file.measurement.depth_column},
                             {"force_column", file.measurement.force_column},
                             {"notes", file.measurement.notes}});
  }
  json["passes"] = nlohmann::ordered_json::array();
  for (const NeedlePass& pass : path.pass) {
    json["passes"].push_back({{"insertion_samples", pass.in_end - pass.in_begin},
                              {"extraction_samples", pass.out_end - pass.out_begin},
                              {"from_m", pass.first_m},
                              {"to_m", pass.turn_m},
                              {"back_to_m", pass.last_m}});
  }
  json.update(to_json(fit));
  for (std::size_t k = 0; k < toughness.size(); ++k) {
    json["layers"][k]["toughness_j_per_m2"] = to_json(toughness[k]);
    if (const std::string warning = toughness_warning(toughness[k]); !warning.empty()) {
      json["layers"][k]["warning"] = warning;
    }
  }
  fmt::print("{}\n", json_text(json));
}

void print_passes(const InsertionRead& read, const NeedlePath& path,
                  const NeedleFit& fit) {
  for (const CurveRead& file : read.files) {
    fmt::print("{:<24} {}, depth \"{}\", force \"{}\"\n", "file", file.layout,
               file.measurement.depth_column, file.measurement.force_column);
  }
  for (std::size_t p = 0; p < path.pass.size(); ++p) {
    const NeedlePass& pass = path.pass[p];
    const std::size_t out = pass.out_end - pass.out_begin;
    fmt::print(
        "{:<24} {} samples from {:.4g} to {:.4g} m{}\n", fmt::format("pass {}", p + 1),
        pass.in_end - pass.in_begin, pass.first_m, pass.turn_m,
        out == 0 ? std::string(", no extraction")
                 : fmt::format(", {} samples back to {:.4g} m", out, pass.last_m));
  }
  fmt::print("{:<24} {} of {} samples; +- is one standard deviation, [] holds 95 %\n",
             "fit", fit.samples, path.depth_m.size());
}

void print_layer(const FittedRupture& rupture, const FittedLayer& layer,
                 std::size_t number) {
  fmt::print("{:<24} {}: pass {}, fall {:.3g} N, {:.0f} standard deviations\n",
             "rupture", number, rupture.pass + 1, rupture.fall_n, rupture.deviations);
  print_estimate("  depth below contact", rupture.depth_m, "m");
  if (number > 1) {
    print_estimate("  boundary at rest", rupture.boundary_m, "m");
  }
  print_estimate("  rupture force", rupture.force_n, "N");
  fmt::print("{:<24} {}\n", "layer", number);
  print_estimate("  cutting force", layer.cutting_n, "N");
  print_estimate("  shaft friction", layer.friction_n_per_m, "N/m");
  if (!layer.cutting_n.refused.empty()) {
    print_estimate("  force at its start", layer.start_n, "N");
    print_estimate("  slope of the force", layer.slope_n_per_m, "N/m");
  }
}

void print_insertion(const InsertionRead& read, const NeedlePath& path,
                     const NeedleFit& fit,
                     const std::vector<IntervalEstimate>& toughness) {
  print_passes(read, path, fit);
  fmt::print("{:<24} c (z - z0)^n before rupture\n", "law");
  print_estimate("coefficient c", fit.coefficient, "N/m^n");
  print_estimate("exponent n", fit.exponent, "");
  print_estimate("contact point z0", fit.contact_m, "m");
  for (std::size_t k = 0; k < fit.ruptures.size(); ++k) {
    print_layer(fit.ruptures[k], fit.layers[k], k + 1);
    if (k < toughness.size()) {
      print_estimate("  toughness", toughness[k], "J/m2");
    }
  }
  print_estimate("static ratio", fit.static_ratio, "");
  print_estimate("presliding stiffness", fit.presliding_n_per_m, "N/m");
  for (const NeedleBaseline& baseline : fit.baselines) {
    print_estimate("drift", baseline.drift_n, "N");
  }
  fmt::print("{:<24} {:>13.6g} N rms{}\n", "residual", fit.rms_n,
             fit.free_rms_n == fit.free_rms_n
                 ? fmt::format(" ({:.3g} N before contact)", fit.free_rms_n)
                 : std::string());
  for (const std::string& note : fit.notes) {
    fmt::print("{:<24} {}\n", "not separated", note);
  }
  if (fit.misses) {
    fmt::print("{:<24} residuals in the tissue are larger than before contact\n",
               "misfit");
  }
  for (const IntervalEstimate& one : toughness) {
    if (const std::string warning = toughness_warning(one); !warning.empty()) {
      fmt::print("{:<24} {}\n", "warning", warning);
    }
  }
}

void run_insertion(InsertionOptions& options) {
  if (!options.scene.empty() && !options.edge_width_mm) {
    throw InputError("--scene: a scene's toughness needs --edge-width-mm");
  }
  if (!options.machine.cycle.empty()) {
    throw InputError("--cycle: insertion fits all passes of its files together");
  }
  const InsertionRead read = read_insertion(options);
  try {
    const NeedlePath path =
        find_needle_path(read.samples, read.frame ? &read.frame->frame : nullptr);
    const NeedleFit fit = fit_needle(path);
    const auto toughness = toughness_of_layers(fit, options);
    if (!options.scene.empty()) {
      write_scene_part(insertion_scene(fit, *options.edge_width_mm * 1e-3),
                       options.scene);
    }
    options.json ? print_insertion_json(read, path, fit, toughness)
                 : print_insertion(read, path, fit, toughness);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", joined_names(options.files), error.what()));
  }
}

}  // namespace

void add_insertion_command(Command app) {
  auto options = std::make_shared<InsertionOptions>();
  Command command = app.add_subcommand(
      "insertion", "Fit ruptures, cutting forces and friction of a needle's passes.");
  command
      .add_option("FILE", options->files,
                  "one file with all passes, or a file of each pass in turn, with one "
                  "origin of depth; layouts as of curve")
      .required();
  const std::string by_header = "; default: as the header tells by its units";
  command.add_option("--depth-column", options->read.given.depth.column,
                     "name or number" + by_header);
  command.add_option("--depth-unit", options->read.given.depth.unit,
                     "m, cm, mm, um, nm, in; default: the header's");
  command.add_option("--force-column", options->read.given.force.column,
                     "name or number" + by_header);
  command.add_option(
      "--force-unit", options->read.given.force.unit,
      "kN, daN, N, cN, mN, uN, nN, pN, gf, kgf, lbf; default: the header's");
  command.add_flag("--ignore-header-units", options->ignore_header_units,
                   "trust the flags where the header states other units");
  command.add_option("--press", options->read.press,
                     "number of the run to fit, where the file holds several");
  command
      .add_option(
          "--speed-mm-per-s", options->speed_mm_per_s,
          "of a file without depths: constant speed over --time-column, inwards "
          "alone")
      .positive();
  command
      .add_option("--edge-width-mm", options->edge_width_mm,
                  "width of the cutting edge: toughness J = F_c / w of each layer")
      .positive();
  command.add_option("--scene", options->scene,
                     "file for the layers and materials of a scene (TOML)");
  add_machine_options(command, options->machine);
  command.add_flag("--json", options->json, "report for programs");
  command.callback([options] {
    run_insertion(*options);
  });
}

}  // namespace palpate
