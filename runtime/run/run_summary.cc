#include <numeric>

#include <fmt/format.h>

#include "runtime/run/render_run.h"

namespace palpate {
namespace {

std::string line(const char* label, const std::string& text) {
  return fmt::format("{:<20}{}\n", label, text);
}

std::string margin_lines(const SimulationReport& report) {
  const double k = report.stiffness.largest_n_per_m() * report.force_scale;
  std::string text =
      report.coupling
          ? line("stiffness", fmt::format("{:.4g} N/m of the coupling's spring", k))
          : line(
                "stiffness",
                fmt::format("{:.4g} N/m at node {}, friction before sliding {:.4g} N/m",
                            report.stiffness.normal_n_per_m, report.stiffness.node,
                            report.stiffness.friction_n_per_m));
  if (report.options.model == LocalModel::kFacets) {
    text += line("", "none at edges, where forces step: no damping is enough there");
  }
  if (report.stiffness.shaft_n_per_m > 0.0) {
    text +=
        line("", fmt::format("and {:.4g} N/m along the needle's shaft in its channel",
                             report.stiffness.shaft_n_per_m));
  }
  if (report.stiffness.lateral_n_per_m > 0.0) {
    text += line("", fmt::format("{:.4g} N/m across the shaft, inserted as far as the "
                                 "body has room",
                                 report.stiffness.lateral_n_per_m));
  }
  if (report.stiffness.border_n_per_m > report.stiffness.largest_n_per_m()) {
    text +=
        line("", fmt::format("{:.4g} N/m at the border of the reach, where it falls "
                             "to nothing within an element",
                             report.stiffness.border_n_per_m));
  }
  if (report.force_scale < 1.0) {
    text +=
        line("limited", fmt::format("forces scaled by {:.4g} to what the device can "
                                    "render",
                                    report.force_scale));
  }
  const std::string table = margin_table(report.bounds, k);
  std::string label = "margin";
  for (std::size_t begin = 0; begin < table.size();) {
    const std::size_t end = table.find('\n', begin);
    text += line(label.c_str(), table.substr(begin, end - begin));
    label.clear();
    begin = end + 1;
  }
  return text;
}

double percent(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string energy_lines(const RenderReport& r) {
  return line("energy of the hand",
              fmt::format("in {:.4g} mJ, out {:.4g} mJ, net {:.4g} mJ",
                          r.energy_in_j * 1e3, r.energy_out_j * 1e3,
                          r.net_energy_j() * 1e3)) +
         line("  in the model",
              fmt::format("work {:.4g} mJ = stored {:.4g} mJ, dissipated {:.4g} mJ, "
                          "tank {:.4g} mJ "
                          "(at most {:.4g} mJ){}",
                          r.model_work_j * 1e3, r.stored_j * 1e3, r.dissipated_j * 1e3,
                          r.tank_j * 1e3, r.tank_max_j * 1e3,
                          r.relaxes ? fmt::format(", dents {:.4g} mJ", r.memory_j * 1e3)
                                    : std::string())) +
         line("rest offset",
              fmt::format("at most {:.4g} mm", r.rest_offset_max_m * 1e3));
}

// What relaxed, and what of it has not recovered yet.
std::string memory_lines(const RenderReport& r) {
  if (!r.relaxes) {
    return {};
  }
  const double whole_n = r.carried_max_n + r.carried_of_n;
  std::string text =
      line(
          "relaxation",
          fmt::format("at most {:.4g} N of {:.4g} N, {:.3g} %", r.carried_max_n,
                      whole_n, whole_n > 0.0 ? 100.0 * r.carried_max_n / whole_n : 0)) +
      line("recovery",
           fmt::format(
               "{} sites still recover, dents hold {:.4g} mJ (at most {:.4g} mJ)",
               r.dents, r.memory_j * 1e3, r.memory_max_j * 1e3));
  if (r.forgotten > 0) {
    text += line("  forgotten",
                 fmt::format("{} dents gave way to newer ones", r.forgotten));
  }
  return text;
}

// What stays of the run for good.
std::string yielding_lines(const SimulationReport& report) {
  const RenderReport& r = report.render;
  if (!r.yields) {
    return {};
  }
  const YieldedRow largest = largest_of(r.surface.yielded);
  std::string text =
      line("yielding",
           fmt::format(
               "{} sites have yielded, dents of at most {:.4g} mm, "
               "softened up to {:.4g} mm{}",
               r.surface.yielded.size(), largest.dent_m * 1e3, largest.softened_m * 1e3,
               follows_surface(report.options.model)
                   ? fmt::format(", {:.4g} mJ dissipated by it", r.yielded_j * 1e3)
                   : std::string()));
  if (r.not_yielded > 0) {
    text += line("  without room",
                 fmt::format("{} times a site stayed as it was, because the table of "
                             "sites is full",
                             r.not_yielded));
  }
  return text;
}

// What a needle broke, and where its work went.
std::string needle_lines(const RenderReport& r) {
  const NeedleReport& n = r.needle;
  if (!n.punctures) {
    return {};
  }
  std::string text =
      line("needle", fmt::format("{} membrane{} broken, {} channel{}, {:.4g} mm deep",
                                 n.broken, n.broken == 1 ? "" : "s", n.channels,
                                 n.channels == 1 ? "" : "s", n.deepest_m * 1e3)) +
      line("  its work",
           fmt::format("{:.4g} mJ cut, {:.4g} mJ released, {:.4g} mJ along the shaft",
                       n.crack_j * 1e3, n.released_j * 1e3, n.shaft_j * 1e3));
  if (n.refused > 0) {
    text += line("  without room",
                 fmt::format("{} ticks could not puncture, because {} channels are "
                             "there already",
                             n.refused, n.channels));
  }
  return text;
}

std::string timing_lines(const RenderReport& r) {
  std::string text =
      line("slow process",
           fmt::format("{} updates, {} late, {} stalls, {} elements dropped",
                       r.slow_updates, r.slow_missed_deadlines, r.slow_stalls,
                       r.elements_dropped)) +
      line("fast process",
           fmt::format("{} ticks, {} missed deadlines, {} starved ({:.2g} %)", r.ticks,
                       r.missed_deadlines, r.starved_ticks,
                       percent(r.starved_ticks, r.ticks))) +
      line("step time",
           fmt::format("p50 {:.0f} ns, p99 {:.0f} ns, p99.9 {:.0f} ns, max {:.0f} ns",
                       r.step_time.percentile_ns(0.5), r.step_time.percentile_ns(0.99),
                       r.step_time.percentile_ns(0.999), r.step_time.max_ns()));
  if (!r.scheduling.empty()) {
    text += line("scheduling", r.scheduling);
  }
  return text;
}

std::string wire_lines(const char* name, const LinkReport& w) {
  constexpr double kMs = 1e6;
  return line(name, fmt::format("{} transactions, {} missed, {:.5g} Hz, {} silences",
                                w.transactions, w.missed, w.rate_hz(), w.silences)) +
         line("  transaction",
              fmt::format("p50 {:.3f} ms, p99 {:.3f} ms, max {:.3f} ms",
                          w.time.percentile_ns(0.5) / kMs,
                          w.time.percentile_ns(0.99) / kMs, w.time.max_ns() / kMs)) +
         line("  age of a force",
              fmt::format("p50 {:.3f} ms, p99 {:.3f} ms, max {:.3f} ms",
                          w.force_age.percentile_ns(0.5) / kMs,
                          w.force_age.percentile_ns(0.99) / kMs,
                          w.force_age.max_ns() / kMs));
}

std::string stream_lines(const StreamReport& s) {
  constexpr double kMib = static_cast<double>(kMebibyte);
  std::string text =
      line("streamed",
           fmt::format(
               "{} chunks loaded, {} given up, {:.3g} % there before they were "
               "asked for, {:.3g} MiB at most, {} of {} updates starved",
               s.cache.loaded, s.cache.evicted, percent(s.cache.hits, s.cache.wanted),
               static_cast<double>(s.cache.bytes_max) / kMib, s.starved, s.updates));
  if (!s.fault.empty()) {
    text += line("FAULT", s.fault);
  }
  return text;
}

std::string served_lines(const ServedReport& s) {
  const std::int64_t all =
      std::accumulate(s.ticks.begin(), s.ticks.end(), std::int64_t{0});
  const auto share = [&](GrownQuality quality) {
    return percent(s.ticks[static_cast<std::size_t>(quality)], all);
  };
  const ServiceStatus& status = s.status;
  std::string text =
      line("service", fmt::format("{}{}{}, {} of {} nodes with an answer, {} final",
                                  name(status.state), status.detail.empty() ? "" : ": ",
                                  status.detail, status.progress.answered,
                                  status.progress.nodes, status.progress.finished)) +
      line("in the body",
           fmt::format(
               "{:.3g} % of ticks without an answer, {:.3g} % with a preliminary "
               "one, "
               "{:.3g} % with a final one",
               share(GrownQuality::kNone), share(GrownQuality::kPreliminary),
               share(GrownQuality::kFinal)));
  if (share(GrownQuality::kEstimated) > 0.0) {
    text += line("", fmt::format("{:.3g} % estimated from the material alone",
                                 share(GrownQuality::kEstimated)));
  }
  if (s.softened > 0) {
    text += line("softened",
                 fmt::format("{} answers, too stiff for the device", s.softened));
  }
  return text;
}

// Who turns the tool, and feels it.
const char* turning_text(const SimulationReport& report) {
  const bool device_turns = report.device_turns, coupled = report.coupling.has_value();
  if (report.torque_felt) {
    return "turned by hands that feel the torque";
  }
  if (device_turns) {
    return coupled
               ? "the grip turns the coupling and the tool on it; no motor turns it "
                 "back, torque is not felt"
               : "the grip turns the tool; no motor turns it back, torque is not "
                 "felt";
  }
  return coupled ? "the device does not turn, torque is not felt"
                 : "the device does not turn the tool, torque is not felt";
}

// The tool, or both.
std::string tools_text(const SimulationReport& report) {
  const auto& together = report.options.together;
  return together
             ? fmt::format("\"{}\" together with \"{}\"", report.tool, together->tool)
             : fmt::format("\"{}\"", report.tool);
}

// What tools of several contacts have beside what one has.
std::string contact_lines(const SimulationReport& report) {
  if (report.contacts == 1) {
    return {};
  }
  const RenderReport& r = report.render;
  return line("contacts",
              fmt::format("{}, coupled; {}", report.contacts, turning_text(report))) +
         line("  table",
              fmt::format("error {}, {}",
                          report.table_error > 0.0
                              ? fmt::format("{:.2g} of force", report.table_error)
                              : "not stated",
                          report.convex
                              ? "one equilibrium wherever it was tried"
                              : "not known to have one equilibrium everywhere")) +
         line("  together", fmt::format("at most {} at once, torque {:.4g} N m, {:.4g} "
                                        "N m/rad in turning; {} ticks coupled less",
                                        r.contacts_max, r.torque_max_n_m,
                                        report.turning_n_m_per_rad, r.scaled_ticks));
}

std::string place_lines(const SimulationReport& report) {
  std::string text;
  for (const PressedPlace* place : {&report.place, &report.second_place}) {
    if (place->node < 0) {
      continue;
    }
    text += line("pressed", describe(*place));
    if (const std::string note = far_note(*place); !note.empty()) {
      text += line("note", note);
    }
  }
  return text;
}

std::string trouble_lines(const SimulationReport& report) {
  std::string text;
  if (!report.render.slow_failure.empty()) {
    text += line("SLOW PROCESS",
                 fmt::format("ended early: {}; the fast process went on with the "
                             "elements that it had",
                             report.render.slow_failure));
  }
  if (report.records_dropped > 0) {
    text += line("RECORDING", fmt::format("{} records dropped, the recorder was late",
                                          report.records_dropped));
  }
  if (!report.recording_failure.empty()) {
    text += line("RECORDING", "ended early: " + report.recording_failure);
  }
  return text;
}

}  // namespace

std::string summary(const SimulationReport& report) {
  const SimulationOptions& o = report.options;
  const RenderReport& r = report.render;
  std::string text =
      line("model", fmt::format("{}, tool {}, fast {:.4g} Hz, slow {:.4g} Hz, {}",
                                name(o.model), tools_text(report), o.fast_hz, o.slow_hz,
                                o.real_time ? "real time" : "simulated time")) +
      (report.served
           ? line("margin", fmt::format("kept answer by answer: at most {:.4g} N/m",
                                        report.bounds.renderable_n_per_m()))
           : margin_lines(report));
  text += contact_lines(report);
  if (report.coupling) {
    text += line("coupling", coupling_text(*report.coupling));
  }
  if (report.resample_loss.nodes > 0) {
    text += line("thinned curves",
                 fmt::format("{} nodes, largest loss {:.3g} N ({:.3g} %)",
                             report.resample_loss.nodes, report.resample_loss.force_n,
                             report.resample_loss.force_relative * 100.0));
  }
  text += line("rendered", fmt::format("{:.4g} s at node {}{}, {:.3g} % in contact",
                                       r.duration_s, report.node,
                                       report.second_node < 0
                                           ? std::string()
                                           : fmt::format(" and {}", report.second_node),
                                       percent(r.contact_ticks, r.ticks)));
  text += place_lines(report);
  text += line("peak", fmt::format("depth {:.4g} mm, force {:.4g} N{}",
                                   r.depth_max_m * 1e3, r.force_max_n,
                                   r.extrapolated_ticks == 0
                                       ? ""
                                       : fmt::format(", beyond the curves in {} ticks",
                                                     r.extrapolated_ticks)));
  text += energy_lines(r);
  if (report.coupling) {
    text += line("  of the coupling", coupling_energy_text(*report.coupling));
  }
  text += memory_lines(r) + yielding_lines(report) + needle_lines(r) + timing_lines(r);
  if (report.wire) {
    text += wire_lines("wire", *report.wire);
  }
  if (report.second_wire) {
    text += wire_lines("second hand's wire", *report.second_wire);
  }
  if (report.stream) {
    text += stream_lines(*report.stream);
  }
  if (report.served) {
    text += served_lines(*report.served);
  }
  text += trouble_lines(report);
  if (r.fault != Fault::kNone) {
    text += line("FAULT", fmt::format("{} after {:.4g} s; force set to zero",
                                      name(r.fault), r.fault_s));
  }
  return text;
}

}  // namespace palpate
