// palpate-fit curve: one measured curve in, its contact point, law and response out.
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fitting/command/commands.h"
#include "fitting/command/curve_file.h"
#include "fitting/command/indenter_flags.h"
#include "fitting/command/machine_options.h"
#include "fitting/curve/fitted_response.h"
#include "fitting/curve/time_effects.h"
#include "fitting/session/corrections_report.h"
#include "fitting/session/press_fit.h"
#include "fitting/session/session_machine.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/base/named_message.h"

namespace palpate {
namespace {

struct CurveOptions {
  CurveFile file;
  bool ignore_header_units = false;
  FitRange range;
  std::vector<double> baseline_m;
  IndenterOptions indenter;
  MachineOptions machine;
  std::string output;
  bool json = false;
};

struct CurveResult {
  CurveRead read;
  std::string tip;  // what was taken of the file's tip
  PressFit press;
};

void compute_curve(const CurveOptions& options, const Indenter& indenter,
                   CurveResult& result) {
  PressFitOptions wanted{.range = options.range, .indenter = indenter, .frame = {}};
  if (!options.baseline_m.empty()) {
    wanted.baseline = FitRange{options.baseline_m[0], options.baseline_m[1]};
  }
  wanted.frame = frame_of(options.machine, [&](const std::string& file) {
    CurveFile plate = options.file;
    plate.file = file;
    plate.press = CurveFile::kNoPress;
    return read_curve_file(plate).measurement.samples;
  });
  Measurement& samples = result.read.measurement.samples;
  try {
    samples = press_of(options.machine, samples);
    result.press = fit_press(samples, wanted);
    if (result.read.timed) {
      result.press.relaxation = find_stepwise_relaxation(
          press_of(options.machine, *result.read.timed), result.press.approach);
    }
  } catch (const InputError& error) {
    throw InputError(with_name(options.file.file, error.what()));
  } catch (const NumericalError& error) {
    throw NumericalError(with_name(options.file.file, error.what()));
  }
}

void print_json(const CurveResult& r, const Indenter& indenter) {
  nlohmann::ordered_json json;
  json["layout"] = r.read.layout;
  json["press"] = r.read.press;
  json["depth_column"] = r.read.measurement.depth_column;
  json["force_column"] = r.read.measurement.force_column;
  json["notes"] = r.read.measurement.notes;
  json["tip"] = r.tip;
  json.update(to_json(r.press, indenter));
  fmt::print("{}\n", json_text(json));
}

void print_line(const std::string& name, double value, double sd,
                const std::string& rest) {
  const std::string spread = sd == sd ? fmt::format(" +- {:.2g}", sd) : "";
  fmt::print("{:<24} {:>13.6g}{:<10} {}\n", name, value, spread, rest);
}

void print_columns(const CurveResult& r, const CurveOptions& options) {
  const auto named = [](const std::string& name, const MeasurementColumn& column) {
    return fmt::format(
        "{}{}", name.empty() ? "column " + column.column : fmt::format("\"{}\"", name),
        column.unit.empty() || column.unit == kUnitFromHeader ? ""
                                                              : " in " + column.unit);
  };
  fmt::print("{:<24} {}{}{}\n", "file", r.read.layout, r.read.press.empty() ? "" : ", ",
             r.read.press);
  fmt::print("{:<24} depth {}, force {}\n", "read",
             named(r.read.measurement.depth_column, options.file.told.depth),
             named(r.read.measurement.force_column, options.file.told.force));
  for (const std::string& note : r.read.measurement.notes) {
    fmt::print("{:<24} {}\n", "", note);
  }
  if (!r.tip.empty()) {
    fmt::print("{:<24} {}\n", "tool", r.tip);
  }
}

// The family that follows the data best, which a database gets.
void print_curve(const FamilyChoice& choice) {
  const FamilyFit& best = choice.fits.front();
  fmt::print(
      "{:<24} {}: {:.3g} N rms{}\n", "curve", best.family, best.rms_n,
      best.misses ? fmt::format(", misses {:.3g} N", best.misfit.missed_rms) : "");
  for (const CurveFeature& feature : choice.features) {
    fmt::print("{:<24} {}\n", "", describe(feature));
  }
}

void print_corrections(const CurveResult& r, const Indenter& indenter) {
  if (r.press.frame) {
    fmt::print("{:<24} {}\n", "frame", describe_frame(r.press.frame));
  }
  const std::string text = corrections_text(r.press.corrections, indenter);
  if (!text.empty()) {
    fmt::print("{:<24} {}\n", "machine", text);
  }
}

void print_curve(const CurveResult& r, const CurveOptions& options,
                 const Indenter& indenter) {
  const auto& approach = r.press.approach;
  print_columns(r, options);
  fmt::print(
      "{:<24} {} of {} samples ({} held, {} retracting, {} spikes, {} outliers)\n",
      "approach", r.press.contact.samples_used,
      r.read.measurement.samples.force_n.size(), approach.hold_samples,
      approach.retract_samples, approach.spikes, r.press.contact.outliers);
  if (r.press.contact.family == "power_law") {
    fmt::print("{:<24} b0 + b1 x + K max(x - x0, 0)^p; +- is one standard deviation\n",
               "law");
    for (const FitParameter& p : r.press.contact.parameters) {
      print_line(p.name, p.value, p.sd,
                 p.held.empty() ? p.unit : fmt::format("{} ({})", p.unit, p.held));
    }
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    if (r.press.contact.contact.m != r.press.contact.contact_point_m) {
      print_line("contact point", r.press.contact.contact.m,
                 r.press.contact.contact.sd_m,
                 "m, of the curve's beginning: the law misses the whole");
    }
    print_line("depth", r.press.contact.depth_max_m, nothing,
               "m beyond the law's contact point");
    print_line("residual", r.press.contact.rms_n, nothing,
               fmt::format("N rms (noise {:.3g} N)", r.press.choice.noise_sd_n));
    print_line("mean stiffness", r.press.contact.mean_stiffness_n_per_m, nothing,
               "N/m");
    print_curve(r.press.choice);
  }
  if (r.press.modulus.refused.empty()) {
    print_line("Young's modulus", r.press.modulus.youngs_modulus_pa,
               r.press.modulus.sd_pa,
               fmt::format("Pa ({}, Poisson's ratio {})", r.press.modulus.law,
                           options.indenter.poissons_ratio));
  } else {
    fmt::print("{:<24} none: {}\n", "Young's modulus", r.press.modulus.refused);
  }
  if (const auto& relaxation = r.press.relaxation) {
    fmt::print("{:<24} {}\n", "relaxation",
               relaxation->refused.empty() ? describe(relaxation->joint)
                                           : "none: " + relaxation->refused);
  }
  print_corrections(r, indenter);
  for (const FitFlag flag : r.press.flags) {
    fmt::print("flag {:<28} {}\n", flag_name(flag), flag_meaning(flag));
  }
}

void run_curve(CurveOptions& options) {
  options.file.header_units =
      options.ignore_header_units ? HeaderUnits::kIgnored : HeaderUnits::kMustAgree;
  options.file.told.time = told_time(options.machine);
  CurveResult result;
  result.read = read_curve_file(options.file);
  result.tip = take_tip(result.read, options.indenter);
  const Indenter indenter = indenter_of(options.indenter);
  const std::optional<ToolShape> tool = rendered_tool(indenter);
  if (!options.output.empty() && !tool) {
    throw InputError(fmt::format(
        "-o needs the tool that pressed as the runtime renders it, and {}: --tool "
        "sphere, flat-punch or cone",
        indenter.shape == "plate" ? "a plate on a cylinder is none" : "none is given"));
  }
  compute_curve(options, indenter, result);
  if (!options.output.empty()) {
    write_database(options.output,
                   sample_patch(best_of(result.press), result.read.measurement.samples,
                                *tool, options.file.file));
  }
  options.json ? print_json(result, indenter) : print_curve(result, options, indenter);
}

}  // namespace

void add_curve_command(Command app) {
  auto options = std::make_shared<CurveOptions>();
  Command command = app.add_subcommand(
      "curve", "Fit contact point, power law and the curve that follows best.");
  command
      .add_option(
          "FILE", options->file.file,
          "what a testing machine or an instrument wrote: text, workbook (xlsx), "
          "Mach-1, Optics11, JPK, afmformats; recognised by what it holds")
      .required();
  const std::string by_header = "; default: as the header tells by its units";
  command.add_option("--depth-column", options->file.told.depth.column,
                     "name or number" + by_header);
  command.add_option("--depth-unit", options->file.told.depth.unit,
                     "m, cm, mm, um, nm, in; default: the header's");
  command.add_option("--force-column", options->file.told.force.column,
                     "name or number" + by_header);
  command.add_option(
      "--force-unit", options->file.told.force.unit,
      "kN, daN, N, cN, mN, uN, nN, pN, gf, kgf, lbf; default: the header's");
  command.add_flag("--ignore-header-units", options->ignore_header_units,
                   "trust the flags where the header states other units");
  command.add_option("--press", options->file.press,
                     "number of the press to fit, where the file holds several");
  command.add_option("--from-m", options->range.from_m, "fit from this displacement");
  command.add_option("--to-m", options->range.to_m, "fit up to this displacement");
  command
      .add_option("--baseline-m", options->baseline_m,
                  "displacements FROM,TO that are surely before contact")
      .separated_by(',')
      .values(2);
  add_indenter_options(command, options->indenter);
  add_machine_options(command, options->machine);
  command.add_option("-o,--output", options->output,
                     "response database of a flat sample with this response");
  command.add_flag("--json", options->json, "report for programs");
  command.callback([options] {
    run_curve(*options);
  });
}

}  // namespace palpate
