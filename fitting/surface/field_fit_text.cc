#include <cmath>

#include <fmt/format.h>

#include "fitting/surface/field_fit.h"
#include "fitting/surface/probe_relaxation.h"

namespace palpate {

std::string describe(const SurfaceFitReport& report) {
  const FieldParameters& p = report.parameters.parameters;
  std::string text = fmt::format(
      "{} runs read: {} behind the field, at {} places; {} left out; farthest from the "
      "surface {:.3g} mm\n"
      "length {:.3g} mm, sd {:.3g}, nugget {:.3g} of log force, smoothness {} ({} "
      "likelihoods, {:.2g} s)\n",
      report.runs, report.probes, report.places, report.left_out.size(),
      1e3 * report.attachment_max_m, 1e3 * p.length_m, p.sd, p.nugget_sd, p.smoothness,
      report.parameters.evaluations, report.parameters.seconds);
  text += std::isnan(report.repeatability)
              ? "nugget: repeatability and roughness, which no repeats tell apart; not "
                "in the nodes' errors\n"
              : fmt::format(
                    "nugget: roughness, in the nodes' errors; presses at one "
                    "place repeat to {:.3g} of log force\n",
                    report.repeatability);
  for (const auto& [law, probes] : report.laws) {
    text += fmt::format("law {}: {} probes\n", law, probes);
  }
  for (const std::string& bound : report.parameters.at_bound) {
    text += fmt::format("parameter at bound: {}\n", bound);
  }
  text += fmt::format("{:>12} {:>8} {:>12} {:>10} {:>14}\n", "depth [mm]", "probes",
                      "one-out rms", "coverage", "nearest's rms");
  for (const DepthScore& d : report.depth) {
    text += fmt::format("{:12.4f} {:8} {:12.4f} {:10.3f} {:14.4f}\n", 1e3 * d.depth_m,
                        d.probes, d.rms, d.coverage, d.nearest_rms);
  }
  if (report.patches.patches > 0) {
    text += fmt::format(
        "{} patches left out and everything fitted without them: {} places predicted, "
        "rms {:.4f}, coverage {:.3f}\n",
        report.patches.patches, report.patches.points, report.patches.rms,
        report.patches.coverage);
  }
  text += fmt::format(
      "median error of the nodes {:.3g}; {} nodes farther than {} lengths from every "
      "probe; {} nodes whose force would have fallen with depth\n",
      report.error_median, report.far_nodes, kFarLengths, report.straightened);
  text += relaxation_text(report.relaxation, report.viscoelasticity,
                          report.relaxation_field);
  for (const LeftOutProbe& probe : report.left_out) {
    text += fmt::format("left out {}: {}\n", probe.name, probe.reason);
  }
  return text;
}

}  // namespace palpate
