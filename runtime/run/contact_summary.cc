#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "runtime/run/contact_run.h"

namespace palpate {

std::string summary(const ContactRunReport& r) {
  std::string text = fmt::format(
      "tools {} ({} contacts on one body, at nodes {})\n",
      r.options.tools.empty() ? "(the only one)"
                              : fmt::format("{}", fmt::join(r.options.tools, ", ")),
      r.contacts, fmt::join(r.node, ", "));
  text +=
      fmt::format("coupling: table error {}, {}\n",
                  r.table_error > 0.0 ? fmt::format("{:.2g} of force", r.table_error)
                                      : "not stated",
                  r.convex ? "one equilibrium wherever it was tried"
                           : "not known to have one equilibrium everywhere");
  if (r.coupling) {
    text += fmt::format("coupling to the device: {}\n", coupling_text(*r.coupling));
  }
  text += fmt::format(
      "stability: {} at most {:.4g} N/m and {:.3g} N m/rad, {:.3g} of what the "
      "device can hold in pressing{}\n",
      r.coupling ? "the coupling's spring" : "contacts together",
      r.margin.stiffness_n_per_m, r.margin.stiffness_n_m_per_rad, r.margin.share,
      r.force_scale < 1.0 ? fmt::format("; forces scaled by {:.3g}", r.force_scale)
                          : "");
  text += fmt::format(
      "{} ticks, {} in contact, {} starved, {} with a scaled coupling; at most {} "
      "contacts at once\n",
      r.ticks, r.contact_ticks, r.starved_ticks, r.scaled_ticks, r.contacts_max);
  text += fmt::format("largest force {:.4g} N, torque {:.4g} N m, depth {:.3g} mm\n",
                      r.force_max_n, r.torque_max_n_m, 1e3 * r.depth_max_m);
  text += fmt::format(
      "energy: work {:.6g} mJ = stored {:.6g} + tank {:.6g} + {}dissipated {:.6g}; "
      "least "
      "work {:.2g} J; relaxed {:.3g} mm, {} changes cut\n",
      1e3 * r.model_work_j, 1e3 * r.stored_j, 1e3 * r.tank_j,
      r.relaxes ? fmt::format("dents {:.6g} + ", 1e3 * r.memory_j) : "",
      1e3 * r.dissipated_j, r.lowest_work_j, 1e3 * r.relaxed_shift_max_m,
      r.interventions);
  if (r.relaxes) {
    text += fmt::format(
        "relaxation: at most {:.4g} N of the contacts' forces had relaxed; each "
        "contact "
        "finds its own dents alone\n",
        r.carried_max_n);
  }
  if (r.yields) {
    text += fmt::format("yielding: dissipated {:.4g} mJ\n", 1e3 * r.yielded_j);
  }
  if (r.coupling) {
    text += fmt::format("  {}\n", coupling_energy_text(*r.coupling));
  }
  text += fmt::format("work of hands and devices against held wrenches: {:.6g} mJ\n",
                      1e3 * r.hand_net_j);
  text += fmt::format("fault: {}\n", name(r.fault));
  return text;
}

std::string to_json(const ContactRunReport& r) {
  return json_text(
      nlohmann::json{{"tools", r.options.tools},
                     {"contacts", r.contacts},
                     {"nodes", r.node},
                     {"table_error", r.table_error},
                     {"convex", r.convex},
                     {"stability_share", r.margin.share},
                     {"stiffness_n_per_m", r.margin.stiffness_n_per_m},
                     {"stiffness_n_m_per_rad", r.margin.stiffness_n_m_per_rad},
                     {"force_scale", r.force_scale},
                     {"ticks", r.ticks},
                     {"contact_ticks", r.contact_ticks},
                     {"starved_ticks", r.starved_ticks},
                     {"scaled_ticks", r.scaled_ticks},
                     {"contacts_max", r.contacts_max},
                     {"depth_max_m", r.depth_max_m},
                     {"force_max_n", r.force_max_n},
                     {"torque_max_n_m", r.torque_max_n_m},
                     {"coupling", r.coupling ? as_json(*r.coupling) : nlohmann::json()},
                     {"hand_net_j", r.hand_net_j},
                     {"model_work_j", r.model_work_j},
                     {"lowest_work_j", r.lowest_work_j},
                     {"stored_j", r.stored_j},
                     {"tank_j", r.tank_j},
                     {"relaxes", r.relaxes},
                     {"memory_j", r.memory_j},
                     {"carried_max_n", r.carried_max_n},
                     {"dissipated_j", r.dissipated_j},
                     {"yields", r.yields},
                     {"yielded_j", r.yielded_j},
                     {"relaxed_shift_max_m", r.relaxed_shift_max_m},
                     {"interventions", r.interventions},
                     {"elements_dropped", r.elements_dropped},
                     {"fault", name(r.fault)}},
      2);
}

}  // namespace palpate
