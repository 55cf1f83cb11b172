#include "runtime/run/several_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
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

// What a tool's contacts are together, into the run.
void note_tool(const PressingTool& tool, std::span<const StiffestNode> contact,
               PressedBody& pressed) {
  PressedTogether& together = *pressed.together;
  together.convex = together.convex && tool.compliance.convex;
  together.table_error = std::max(together.table_error, tool.compliance.error_relative);
  // What a device damps does not matter for the stiffness alone.
  const WrenchMargin margin =
      wrench_margin(contact_stiffness(tool, contact), 1.0, 0.0, 1.0, 0.0);
  together.turning_n_m_per_rad =
      std::max(together.turning_n_m_per_rad, margin.stiffness_n_m_per_rad);
  const RenderedStiffness sum = stiffness_of_contacts(contact);
  if (pressed.stiffness.node < 0 ||
      sum.largest_n_per_m() > pressed.stiffness.largest_n_per_m()) {
    pressed.stiffness = sum;
  }
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
    refuse(
        "a scene that is computed meanwhile has no table of compliance yet, build its "
        "database first");
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

PressedBody pressed_by_several(const ResponseSource& source, PressedBody pressed,
                               const SimulationOptions& options,
                               std::vector<TableElements*>& handed_out) {
  std::vector<std::string> names{pressed.tool.name};
  std::vector<PressingTool> tools{source.tool(options.tool)};
  pressed.together.emplace();
  pressed.script =
      script_of(std::move(pressed.script), tools[0].shape, is_simulated(options, 0));
  if (options.together) {
    tools.push_back(source.tool(options.together->tool));
    names.push_back(tools[1].shape.name);
    const PlaceToPress second =
        place_on(source, names[1], options.together->at_m, options.force_max_n);
    pressed.together->second_place = second.place;
    pressed.together->second_script =
        script_of(second.script, tools[1].shape, is_simulated(options, 1));
  }
  pressed.contacts = coupled_set(tools).count;
  pressed.tables = response_names(tools);
  pressed.stiffness = {};
  for (const PressingTool& tool : tools) {
    note_tool(tool,
              source.stiffest(tool.shape.name, options.model, options.force_max_n),
              pressed);
  }
  pressed.several = [&source, &handed_out, names](const FastConfig& config,
                                                  const ContactsHeld& held,
                                                  const Eigen::Vector3d& start_m) {
    auto stream = source.contacts(names, held.force_scale, start_m);
    for (const auto& table : stream->elements()) {
      handed_out.push_back(table.get());
    }
    return std::make_unique<SeveralContacts>(std::move(stream), config, held);
  };
  return pressed;
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
