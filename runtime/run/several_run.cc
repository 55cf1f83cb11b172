#include "runtime/run/several_run.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

void check_several(const ToolShape& tool, const SimulationOptions& options,
                   bool in_memory) {
  if (tool.contact.empty()) {
    if (options.coupling) {
      throw InputError(
          fmt::format("--coupling: tool \"{}\" touches at one place; a coupling is for "
                      "tools of several contacts",
                      tool.name));
    }
    return;
  }
  const auto refuse = [&](const char* why) {
    throw InputError(fmt::format("tool \"{}\" has {} contacts: {}", tool.name,
                                 tool.contact.radius_m.size(), why));
  };
  if (!in_memory) {
    refuse("the database must fit in memory, leave out --stream");
  }
  if (!is_field(options.model)) {
    refuse("the local model must be potential or facets");
  }
  if (!options.recording.file.empty()) {
    refuse("a device's run of it is not recorded, leave out --record");
  }
}

void soften_coupling(SimulationReport& report, const DeviceLimits& limits) {
  VirtualCoupling c = *report.options.coupling;
  const double renderable = report.bounds.renderable_n_per_m();
  if (c.spring_n_per_m > renderable) {
    if (!report.options.limit_stiffness) {
      throw InputError(fmt::format(
          "the device cannot render this coupling: its spring of {:.4g} N/m "
          "exceeds {:.4g} N/m; --limit-stiffness softens it to that",
          c.spring_n_per_m, renderable));
    }
    c.spring_n_per_m = renderable;
  }
  report.stiffness.normal_n_per_m = c.spring_n_per_m;
  report.stiffness.friction_n_per_m = c.spring_n_per_m;
  report.coupling = coupling_on(c, limits, report.hold_s);
}

}  // namespace palpate
