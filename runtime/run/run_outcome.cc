#include "runtime/run/run_outcome.h"

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"

namespace palpate {
namespace {

nlohmann::json as_json(const StreamReport& stream) {
  return {{"updates", stream.updates},
          {"starved", stream.starved},
          {"chunks_loaded", stream.cache.loaded},
          {"chunks_evicted", stream.cache.evicted},
          {"chunks_wanted", stream.cache.wanted},
          {"chunks_hit", stream.cache.hits},
          {"bytes_max", stream.cache.bytes_max},
          {"fault", stream.fault}};
}

nlohmann::json as_json(const LinkReport& wire) {
  return {{"transactions", wire.transactions},
          {"missed", wire.missed},
          {"silences", wire.silences},
          {"rate_hz", wire.rate_hz()},
          {"p50_ns", wire.time.percentile_ns(0.5)},
          {"p99_ns", wire.time.percentile_ns(0.99)},
          {"max_ns", wire.time.max_ns()},
          {"force_age_p50_ns", wire.force_age.percentile_ns(0.5)},
          {"force_age_p99_ns", wire.force_age.percentile_ns(0.99)},
          {"force_age_max_ns", wire.force_age.max_ns()}};
}

nlohmann::json as_json(const ServedReport& served) {
  const auto ticks = [](const QualityTicks& at) {
    nlohmann::json row;
    for (std::size_t i = 0; i < at.size(); ++i) {
      row[std::string(name(static_cast<GrownQuality>(i)))] = at[i];
    }
    return row;
  };
  nlohmann::json seconds = nlohmann::json::array();
  for (const QualityTicks& second : served.by_second) {
    seconds.push_back(ticks(second));
  }
  const ServiceStatus& status = served.status;
  return {{"state", name(status.state)},
          {"detail", status.detail},
          {"stage", status.progress.stage},
          {"nodes", status.progress.nodes},
          {"answered", status.progress.answered},
          {"finished", status.progress.finished},
          {"joins", status.joins},
          {"answers", status.answers},
          {"softened", served.softened},
          {"ticks", ticks(served.ticks)},
          {"by_second", seconds}};
}

// Null of a tool that is no needle.
nlohmann::json needle_json(const NeedleReport& n) {
  if (!n.punctures) {
    return nullptr;
  }
  return {{"channels", n.channels}, {"broken", n.broken},
          {"refused", n.refused},   {"deepest_m", n.deepest_m},
          {"crack_j", n.crack_j},   {"released_j", n.released_j},
          {"shaft_j", n.shaft_j}};
}

// What the surface remembers, for a while and for good.
nlohmann::json memory_json(const RenderReport& r) {
  const YieldedRow largest = largest_of(r.surface.yielded);
  return {{"relaxes", r.relaxes},
          {"carried_max_n", r.carried_max_n},
          {"carried_of_n", r.carried_of_n},
          {"dents", r.dents},
          {"forgotten", r.forgotten},
          {"yields", r.yields},
          {"yielded_j", r.yielded_j},
          {"yielded_sites", r.surface.yielded.size()},
          {"largest_dent_m", largest.dent_m},
          {"softened_m", largest.softened_m},
          {"not_yielded", r.not_yielded}};
}

nlohmann::json device_json(const SimulationReport& report) {
  return {{"device", report.device},
          {"second_device", report.second_device.empty()
                                ? nlohmann::json()
                                : nlohmann::json(report.second_device)},
          {"device_failure", report.device_failure},
          {"device_turns", report.device_turns}};
}

// What was felt, by the forces as they were held, and where the account has it.
nlohmann::json energy_json(const RenderReport& r) {
  return {{"energy_in_j", r.energy_in_j},
          {"energy_out_j", r.energy_out_j},
          {"held_s", r.held_s},
          {"net_energy_j", r.net_energy_j()},
          {"model_work_j", r.model_work_j},
          {"lowest_work_j", r.lowest_work_j},
          {"stored_j", r.stored_j},
          {"dissipated_j", r.dissipated_j},
          {"tank_j", r.tank_j},
          {"tank_max_j", r.tank_max_j},
          {"memory_j", r.memory_j},
          {"memory_max_j", r.memory_max_j}};
}

// The node that a hand presses; null: there is no such hand.
nlohmann::json as_json(const PressedPlace& place) {
  if (place.node < 0) {
    return {};
  }
  const Eigen::Vector3d& p = place.position_m;
  return {{"node", place.node},
          {"position_m", {p.x(), p.y(), p.z()}},
          {"edge_m", place.edge_m},
          {"off_m", place.off_m ? nlohmann::json(*place.off_m) : nlohmann::json()},
          {"note", far_note(place)}};
}

// What tools of several contacts have beside what one has.
nlohmann::json contacts_json(const SimulationReport& report) {
  const RenderReport& r = report.render;
  const auto& together = report.options.together;
  return {{"contacts", report.contacts},
          {"second_tool", together ? nlohmann::json(together->tool) : nlohmann::json()},
          {"second_node", report.second_node},
          {"second_place", as_json(report.second_place)},
          {"contacts_max", r.contacts_max},
          {"scaled_ticks", r.scaled_ticks},
          {"torque_max_n_m", r.torque_max_n_m},
          {"turning_n_m_per_rad", report.turning_n_m_per_rad},
          {"table_error", report.table_error},
          {"convex", report.convex}};
}

}  // namespace

nlohmann::json as_json(const SimulationReport& report) {
  const RenderReport& r = report.render;
  nlohmann::json json{
      {"model", name(report.options.model)},
      {"tool", report.tool},
      {"coupling", report.coupling ? as_json(*report.coupling) : nlohmann::json()},
      {"node", report.node},
      {"place", as_json(report.place)},
      {"fast_hz", report.options.fast_hz},
      {"slow_hz", report.options.slow_hz},
      {"real_time", report.options.real_time},
      {"stiffness_max_n_per_m", report.stiffness.normal_n_per_m},
      {"friction_stiffness_n_per_m", report.stiffness.friction_n_per_m},
      {"shaft_stiffness_n_per_m", report.stiffness.shaft_n_per_m},
      {"lateral_stiffness_n_per_m", report.stiffness.lateral_n_per_m},
      {"border_stiffness_n_per_m", report.stiffness.border_n_per_m},
      {"passivity_bound_n_per_m", report.bounds.passivity_n_per_m},
      {"sampling_bound_n_per_m", report.bounds.sampling_n_per_m},
      {"delay_bound_n_per_m", report.bounds.delay_n_per_m},
      {"quantisation_bound_n_per_m", report.bounds.quantisation_n_per_m},
      {"renderable_n_per_m", report.bounds.renderable_n_per_m()},
      {"force_scale", report.force_scale},
      {"duration_s", r.duration_s},
      {"ticks", r.ticks},
      {"contact_ticks", r.contact_ticks},
      {"starved_ticks", r.starved_ticks},
      {"extrapolated_ticks", r.extrapolated_ticks},
      {"missed_deadlines", r.missed_deadlines},
      {"slow_updates", r.slow_updates},
      {"slow_missed_deadlines", r.slow_missed_deadlines},
      {"slow_stalls", r.slow_stalls},
      {"elements_dropped", r.elements_dropped},
      {"depth_max_m", r.depth_max_m},
      {"force_max_n", r.force_max_n},
      {"rest_offset_max_m", r.rest_offset_max_m},
      {"step_p50_ns", r.step_time.percentile_ns(0.5)},
      {"step_p99_ns", r.step_time.percentile_ns(0.99)},
      {"step_p999_ns", r.step_time.percentile_ns(0.999)},
      {"step_max_ns", r.step_time.max_ns()},
      {"late_reads", r.late_reads},
      {"slow_failure", r.slow_failure},
      {"scheduling", r.scheduling},
      {"wire", report.wire ? as_json(*report.wire) : nlohmann::json()},
      {"second_wire",
       report.second_wire ? as_json(*report.second_wire) : nlohmann::json()},
      {"records_dropped", report.records_dropped},
      {"recording_failure", report.recording_failure},
      {"stream", report.stream ? as_json(*report.stream) : nlohmann::json()},
      {"service", report.served ? as_json(*report.served) : nlohmann::json()},
      {"fault", name(r.fault)},
      {"interrupted", r.interrupted}};
  json.update(contacts_json(report));
  json.update(energy_json(r));
  json.update(memory_json(r));
  json["needle"] = needle_json(r.needle);
  json.update(device_json(report));
  return json;
}

void throw_what_ended(const SimulationReport& report) {
  const Fault fault = report.render.fault;
  if (fault != Fault::kNone) {
    const std::string what = fmt::format("stopped by fault \"{}\" after {:.4g} s",
                                         name(fault), report.render.fault_s);
    if (fault == Fault::kDeviceLost || fault == Fault::kDeviceSilent) {
      throw DeviceError(fmt::format("{}: {}{}{}", report.device, what,
                                    report.device_failure.empty() ? "" : ": ",
                                    report.device_failure));
    }
    throw NumericalError(
        fault == Fault::kSlowWire
            ? fmt::format("{}: {}: its wire held forces for {:.3g} ms, the margin "
                          "allows for {:.3g} ms",
                          report.device, what, 1e3 * report.render.held_s,
                          1e3 * report.hold_s)
            : what);
  }
  if (report.stream && !report.stream->fault.empty()) {
    throw FormatError(report.stream->fault);
  }
  if (report.render.slow_error != nullptr) {
    std::rethrow_exception(report.render.slow_error);
  }
  if (!report.recording_failure.empty()) {
    throw InputError(report.recording_failure);
  }
  if (report.render.interrupted) {
    throw Interrupted();
  }
}

}  // namespace palpate
