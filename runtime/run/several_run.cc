#include "runtime/run/several_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/hand/press_site.h"
#include "runtime/run/hand_seat.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/contact_stiffness.h"

namespace palpate {
namespace {

// [m] height of the upright tool's reference point when it touches a plane.
double touch_height_m(const ToolShape& tool) {
  if (tool.contact.empty()) {
    return nominal_height_m(tool);
  }
  double height = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tool.contact.radius_m.size(); ++i) {
    height =
        std::max(height, tool.contact.radius_m[i] -
                             tool.contact.point_m(static_cast<Eigen::Index>(i), 2));
  }
  return height;
}

// Upright on the surface, where a wrist turns the tool; else with its axes along the
// body's.
MakeScript script_of(MakeScript alone, const ToolShape& tool, bool turned) {
  return [alone = std::move(alone), &tool, turned](double scale, double hand_n_per_m) {
    HandScript pressed = alone(scale, hand_n_per_m);
    const ContactSet& contact = tool.contact;
    if (turned) {
      pressed.touch_m += touch_height_m(tool) - nominal_height_m(tool);
    } else if (!contact.empty()) {
      pressed.touch_m = (Eigen::Map<const Eigen::VectorXd>(
                             contact.radius_m.data(), std::ssize(contact.radius_m)) -
                         contact.point_m * pressed.normal)
                            .maxCoeff();
    }
    return pressed;
  };
}

RenderedStiffness stiffer(const RenderedStiffness& a, const RenderedStiffness& b) {
  return a.largest_n_per_m() >= b.largest_n_per_m() ? a : b;
}

void note_table(const ResponseDatabase& database, const ResponseTable& table,
                const SimulationOptions& options, PressedTogether& together) {
  together.convex = together.convex && table.compliance.convex;
  together.table_error =
      std::max(together.table_error, table.compliance.error_relative);
  // What a device damps does not matter for the stiffness alone.
  const WrenchMargin margin = wrench_margin(
      contact_stiffness(database, table, options.model, options.force_max_n), 1.0, 0.0,
      1.0 / options.fast_hz, 0.0);
  together.turning_n_m_per_rad =
      std::max(together.turning_n_m_per_rad, margin.stiffness_n_m_per_rad);
}

}  // namespace

void check_several(const ToolShape& tool, const SimulationOptions& options,
                   bool several) {
  if (tool.contact.empty() && !options.together) {
    if (options.coupling) {
      throw InputError(
          fmt::format("--coupling: tool \"{}\" touches at one place; a coupling is for "
                      "tools of several contacts",
                      tool.name));
    }
    return;
  }
  const auto refuse = [&](const char* why) {
    throw InputError(fmt::format(
        "tool \"{}\" has {}: {}", tool.name,
        options.together ? fmt::format("\"{}\" beside it", options.together->tool)
                         : fmt::format("{} contacts", tool.contact.radius_m.size()),
        why));
  };
  if (!several) {
    refuse("the database must fit in memory, leave out --stream");
  }
  if (!is_field(options.model)) {
    refuse("the local model must be potential or facets");
  }
  if (!(std::abs(options.tilt_rad) <= 1.0) || !(std::abs(options.turn_rad) <= 3.0)) {
    throw InputError(
        fmt::format("tilt and turn are {} and {} rad, must be at most 1 and 3",
                    options.tilt_rad, options.turn_rad));
  }
}

PressedBody pressed_by_several(const ResponseDatabase& database,
                               const ResponseTable& table, PressedBody body,
                               const SimulationOptions& options) {
  const auto stiffness_of = [&](const ResponseTable& each) {
    return stiffness_of_contacts(database, each, options.model, options.force_max_n);
  };
  std::vector<const ResponseTable*> tools{&table};
  PressedTogether together;
  body.stiffness = stiffness_of(table);
  const bool turned = is_simulated(options, 0);
  if (options.together) {
    const ResponseTable& second = find_tool(database, options.together->tool);
    tools.push_back(&second);
    body.stiffness = stiffer(body.stiffness, stiffness_of(second));
    together.second_node = node_to_press(database, second, options.together->at_m);
    together.second_script = script_of(
        [&database, &second, node = together.second_node,
         force_max_n = options.force_max_n](double scale, double hand_n_per_m) {
          return script_at(database, second, node, force_max_n, scale, hand_n_per_m);
        },
        second.tool, is_simulated(options, 1));
  }
  body.contacts = coupled_set(tools).count;
  for (const ResponseTable* each : response_tables(database, tools)) {
    body.tables.push_back(each->tool.name);
  }
  for (const ResponseTable* each : tools) {
    note_table(database, *each, options, together);
  }
  body.several = [&database, tools](const FastConfig& config,
                                    const ContactsHeld& held) {
    return std::make_unique<SeveralContacts>(database, tools, config, held);
  };
  body.script = script_of(std::move(body.script), table.tool, turned);
  body.together = std::move(together);
  return body;
}

bool is_contact_run(const ResponseDatabase& database,
                    const std::vector<std::string>& tools, bool together) {
  bool sets = false;
  for (const std::string& tool : tools) {
    sets = sets || !find_tool(database, tool).tool.contact.empty();
  }
  if (tools.empty()) {
    sets = !find_tool(database, "").tool.contact.empty();
  }
  if (sets && tools.size() > 1 && !together) {
    throw InputError(
        "a tool of several contacts is rendered alone, or with a second one by "
        "--together");
  }
  return sets || together;
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
