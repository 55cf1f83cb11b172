// `palpate-run probe`: prints what a probe of a device found.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/attach/probe_file.h"
#include "runtime/command/commands.h"
#include "runtime/device/stability_margin.h"

namespace palpate {
namespace {

struct ProbeFlags {
  std::filesystem::path file;
  double fast_hz = 1000.0;
  bool json = false;
};

void print_probe(const ProbeFlags& flags) {
  if (!(flags.fast_hz > 0.0 && flags.fast_hz <= 1e5)) {
    throw InputError(
        fmt::format("--fast-hz is {} Hz, must lie in (0, 100000]", flags.fast_hz));
  }
  const ProbeReport report = read_probe(flags.file);
  const DeviceLimits limits = probed_limits(report, {});
  const StabilityBounds bounds =
      stability_bounds(limits, std::max(1.0 / flags.fast_hz, limits.hold_s));
  if (flags.json) {
    nlohmann::ordered_json json = parse_ordered_json(probe_json(report));
    for (auto& axis : json["axes"]) {
      axis.erase("pushes");
    }
    json["renderable_n_per_m"] = bounds.renderable_n_per_m();
    fmt::print("{}\n", json_text(json, 2));
    return;
  }
  const std::string missing = axes_not_found(report);
  const std::string elsewhere =
      missing.empty() ? "" : fmt::format(" along other axes than {}", missing);
  fmt::print(
      "{}at {:g} Hz it holds a stiffness of {:.3g} N/m{}: {:.3g} by damping and delay, "
      "{:.3g} by friction and step\n",
      probe_text(report), flags.fast_hz, bounds.renderable_n_per_m(), elsewhere,
      bounds.delay_n_per_m, bounds.quantisation_n_per_m);
}

}  // namespace

void add_probe_command(Command app) {
  Command command = app.add_subcommand(
      "probe", "Print what a probe of a device found (device --probe FILE).");
  const auto flags = std::make_shared<ProbeFlags>();
  command.add_option("file", flags->file, "The probe's file (JSON)").required();
  command
      .add_option("--fast-hz", flags->fast_hz,
                  "Rate of force updates at which stiffness is judged [Hz]")
      .show_default();
  command.add_flag("--json", flags->json, "Print it for programs, without its samples");
  command.callback([flags] {
    print_probe(*flags);
  });
}

}  // namespace palpate
