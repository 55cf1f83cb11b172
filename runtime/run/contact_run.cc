#include "runtime/run/contact_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/device/stability_margin.h"
#include "runtime/hand/press_site.h"
#include "runtime/hand/turn_script.h"
#include "runtime/run/pose_trace.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/contact_stiffness.h"
#include "runtime/slow/coupled_storage.h"

namespace palpate {
namespace {

void check(const ContactRunOptions& options) {
  const auto positive = [](const char* what, double value) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw InputError(
          fmt::format("{} is {}, must be positive and finite", what, value));
    }
  };
  positive("duration [s]", options.duration_s);
  positive("fast rate [Hz]", options.fast_hz);
  positive("slow rate [Hz]", options.slow_hz);
  positive("largest force [N]", options.force_max_n);
  if (options.slow_hz > options.fast_hz || options.fast_hz > 1e5) {
    throw InputError(
        fmt::format("rates are {} and {} Hz, must be at most 100000 Hz, the "
                    "slow one at most the fast one",
                    options.fast_hz, options.slow_hz));
  }
  if (!(std::abs(options.tilt_rad) <= 1.0) || !(std::abs(options.turn_rad) <= 3.0)) {
    throw InputError(
        fmt::format("tilt and turn are {} and {} rad, must be at most 1 and "
                    "3",
                    options.tilt_rad, options.turn_rad));
  }
}

std::vector<const ResponseTable*> tables_of(const ResponseDatabase& database,
                                            const std::vector<std::string>& tools) {
  std::vector<const ResponseTable*> tables;
  for (const std::string& tool : tools) {
    tables.push_back(&find_tool(database, tool));
  }
  if (tables.empty()) {
    tables.push_back(&find_tool(database, ""));
  }
  return tables;
}

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

WrenchMargin margin_of(const ResponseDatabase& database, const ResponseTable& table,
                       const ContactRunOptions& options, const DeviceLimits& limits) {
  // No simulated device pushes against turns, so translations alone are checked.
  return wrench_margin(
      contact_stiffness(database, table, options.model, options.force_max_n),
      limits.damping_n_s_per_m, 0.0, 1.0 / options.fast_hz, limits.delay_s);
}

// A hand with its device.
struct Hand {
  HandScript script;
  TurnScript wrist;
  std::unique_ptr<SimulatedDevice> device;
};

// What renders.
class ContactRun {
 public:
  ContactRun(const ResponseDatabase& database, const ContactRunOptions& options)
      : database_(database), tables_(tables_of(database, options.tools)) {
    check(options);
    report_.options = options;
    if (!options.at_m.empty() && options.at_m.size() != tables_.size()) {
      throw InputError(
          fmt::format("{} places for {} tools", options.at_m.size(), tables_.size()));
    }
    report_.options.device.tick_s = 1.0 / options.fast_hz;
    report_.options.device.force_max_n = options.force_max_n;
    find_scale();
    stream_ = std::make_unique<ContactStream>(database, tables_, report_.force_scale);
    FastConfig fast;
    fast.model = options.model;
    fast.force_max_n = options.force_max_n;
    fast.ramp_s = options.ramp_s;
    storage_.emplace(stream_->set(), fast);
    if (report_.coupling) {
      hang_tools();
    }
    report_.contacts = stream_->set().count;
    for (const ResponseTable* table : tables_) {
      report_.tools.push_back(table->tool.name);
    }
    for (std::size_t i = 0; i < tables_.size(); ++i) {
      add_hand(i);
    }
    poses_ = std::move(report_.options.given);
    if (poses_.empty() && !options.poses.empty()) {
      poses_ = read_poses(options.poses, static_cast<int>(tables_.size()));
    }
  }

  ContactRunReport run(const std::atomic<bool>& stop) {
    const ContactRunOptions& o = report_.options;
    const auto ticks = poses_.empty()
                           ? static_cast<std::int64_t>(o.duration_s * o.fast_hz)
                           : static_cast<std::int64_t>(poses_.size());
    const auto per_slow =
        std::max<std::int64_t>(1, std::llround(o.fast_hz / o.slow_hz));
    for (auto& hand : hands_) {
      hand.device->open();
    }
    for (std::int64_t tick = 0; tick < ticks && !stop.load(); ++tick) {
      if (tick > 0 && tick % per_slow == 0) {
        serve();
      }
      if (!turn(tick)) {
        break;
      }
    }
    for (auto& hand : hands_) {
      hand.device->close();
      report_.hand_net_j -= hand.device->rendered_work_j();
    }
    report_.interventions = account_of(storage_->state()).interventions;
    if (hung_ != nullptr) {
      report_.coupling->account = hung_->account;
    }
    report_.elements_dropped = fifo_->dropped();
    if (!o.trace.empty()) {
      write_pose_trace(o.trace, static_cast<int>(tables_.size()), trace_);
    }
    if (o.keep) {
      report_.kept = std::move(trace_);
    }
    return report_;
  }

 private:
  void find_scale() {
    const ContactRunOptions& o = report_.options;
    SimulatedClock clock;
    const DeviceLimits limits =
        SimulatedDevice(o.device, HandScript{}, clock, {}).limits();
    report_.convex = true;
    for (const ResponseTable* table : tables_) {
      const WrenchMargin margin = margin_of(database_, *table, o, limits);
      if (margin.share > report_.margin.share) {
        report_.margin = margin;
      }
      report_.yields = report_.yields || !table->viscoelasticity.yielding.empty();
      report_.relaxes = report_.relaxes || !table->viscoelasticity.empty();
      report_.convex = report_.convex && table->compliance.convex;
      report_.table_error =
          std::max(report_.table_error, table->compliance.error_relative);
    }
    if (o.coupling) {
      soften_coupling(limits);
      return;
    }
    const std::string reason =
        why_not_renderable(report_.margin, limits.damping_n_s_per_m, 0.0);
    if (o.force_scale) {
      report_.force_scale = *o.force_scale;
      return;
    }
    if (reason.empty()) {
      return;
    }
    report_.force_scale = 1.0 / report_.margin.share;
    if (!o.limit_stiffness) {
      throw InputError(
          fmt::format("the device cannot render this: {}; --limit-stiffness scales "
                      "forces by {:.3g}",
                      reason, report_.force_scale));
    }
  }

  // With a coupling its spring is what counts (coupling_margin()).
  void soften_coupling(const DeviceLimits& limits) {
    VirtualCoupling c = *report_.options.coupling;
    const double hold_s = 1.0 / report_.options.fast_hz;
    const WrenchMargin spring = coupling_margin(c, limits, hold_s);
    if (spring.share > 1.0) {
      const double softer_n_per_m = c.spring_n_per_m / spring.share;
      if (!report_.options.limit_stiffness) {
        throw InputError(
            fmt::format("the device cannot render this coupling: its spring of {:.4g} "
                        "N/m is {:.3g} times what the device can hold; "
                        "--limit-stiffness softens it to {:.4g} N/m",
                        c.spring_n_per_m, spring.share, softer_n_per_m));
      }
      c.spring_n_per_m = softer_n_per_m;
    }
    report_.margin = coupling_margin(c, limits, hold_s);
    report_.coupling = coupling_on(c, limits, hold_s);
  }

  void hang_tools() {
    hung_ = std::make_unique<HungTool>();
    if (const char* wrong =
            hang(*hung_, storage_->state(), report_.coupling->coupling)) {
      throw InputError(fmt::format("coupling: {}", wrong));
    }
  }

  void add_hand(std::size_t i) {
    const ContactRunOptions& o = report_.options;
    const ResponseTable& table = *tables_[i];
    const std::int32_t node = node_to_press(
        database_, table,
        o.at_m.empty() ? std::nullopt : std::optional<Eigen::Vector3d>(o.at_m[i]));
    report_.node.push_back(node);
    Hand hand;
    hand.script = script_at(database_, table, node, o.force_max_n, report_.force_scale,
                            o.device.hand_n_per_m);
    hand.script.touch_m += touch_height_m(table.tool) - nominal_height_m(table.tool);
    hand.wrist = {
        .normal = hand.script.normal, .tilt_rad = o.tilt_rad, .turn_rad = o.turn_rad};
    hand.device = std::make_unique<SimulatedDevice>(
        o.device, hand.script, clock_,
        SimulatedMotion{.position_m = hand.script.at(0.0).position_m});
    hands_.push_back(std::move(hand));
  }

  // One slow turn.
  void serve() {
    (void)stream_->update(
        contact_tool_state(storage_->state(),
                           static_cast<std::uint64_t>(report_.ticks + 1)),
        clock_.now_ns(), *fifo_, sent_);
  }

  PoseTick sampled(std::int64_t tick) {
    if (!poses_.empty()) {
      return poses_[static_cast<std::size_t>(tick)];
    }
    PoseTick at;
    at.time_s = static_cast<double>(tick) / report_.options.fast_hz;
    for (std::size_t i = 0; i < hands_.size(); ++i) {
      DeviceReading reading;
      (void)hands_[i].device->read(reading);
      at.pose[i] = {reading.position_m, hands_[i].wrist.at(at.time_s)};
    }
    return at;
  }

  // One fast turn. False after a fault.
  bool turn(std::int64_t tick) {
    PoseTick at = sampled(tick);
    clock_.sleep_until_ns(std::llround(at.time_s * kNanosecondsPerSecond));
    if (report_.ticks == 0) {
      first_contacts(at);
    }
    while (const ContactElement* message = fifo_->front()) {
      accept(storage_->state(), *message);
      fifo_->pop();
    }
    CoupledSample sample;
    sample.time_ns = clock_.now_ns();
    for (std::size_t i = 0; i < hands_.size(); ++i) {
      sample.pose[i] = {at.pose[i].position_m, at.pose[i].turn.toRotationMatrix()};
    }
    const double dt_s =
        report_.ticks == 0 ? 1.0 / report_.options.fast_hz : at.time_s - last_.time_s;
    CoupledState& state = storage_->state();
    at.command = hung_ != nullptr ? step(*hung_, state, sample, dt_s)
                                  : step(state, sample, dt_s);
    at.work_j = hung_ != nullptr ? hung_->total.work_j : account_of(state).work_j;
    for (std::size_t i = 0; i < hands_.size() && poses_.empty(); ++i) {
      (void)hands_[i].device->write(at.command.wrench[i].force_n);
    }
    account(at);
    last_ = at;
    if (!report_.options.trace.empty() || report_.options.keep) {
      trace_.push_back(at);
    }
    return report_.fault == Fault::kNone;
  }

  // The slow process looks where the tools are before the first tick.
  void first_contacts(const PoseTick& at) {
    ContactToolState state;
    state.sequence = 1;
    state.count = stream_->set().count;
    PortPoses pose;
    for (std::size_t i = 0; i < hands_.size(); ++i) {
      pose[i] = {at.pose[i].position_m, at.pose[i].turn.toRotationMatrix()};
    }
    for (int i = 0; i < state.count; ++i) {
      state.contact[static_cast<std::size_t>(i)].position_m =
          centre_of(stream_->set(), pose, i);
    }
    (void)stream_->update(state, 0, *fifo_, sent_);
  }

  void account(const PoseTick& at) {
    ContactRunReport& r = report_;
    const CoupledCommand& c = at.command;
    if (r.ticks > 0) {
      r.hand_net_j += work_of_hands_j(last_, at, hands_.size(), !poses_.empty());
    }
    ++r.ticks;
    r.contact_ticks += c.in_contact ? 1 : 0;
    r.starved_ticks += c.starved ? 1 : 0;
    r.scaled_ticks += c.scaled ? 1 : 0;
    r.contacts_max = std::max(r.contacts_max, c.contacts);
    r.depth_max_m = std::max(r.depth_max_m, c.depth_m);
    for (const Wrench& wrench : c.wrench) {
      r.force_max_n = std::max(r.force_max_n, wrench.force_n.norm());
      r.torque_max_n_m = std::max(r.torque_max_n_m, wrench.torque_n_m.norm());
    }
    r.model_work_j = at.work_j;
    r.lowest_work_j = std::min(r.lowest_work_j, at.work_j);
    r.stored_j = c.stored_j;
    r.tank_j = c.tank_j;
    r.memory_j = c.memory_j;
    r.carried_max_n = std::max(r.carried_max_n, c.carried_n);
    r.dissipated_j = c.dissipated_j;
    r.yielded_j = c.yielded_j;
    r.relaxed_shift_max_m = std::max(r.relaxed_shift_max_m, c.relaxed_shift_m);
    r.fault = static_cast<Fault>(c.fault);
  }

  const ResponseDatabase& database_;
  std::vector<const ResponseTable*> tables_;
  ContactRunReport report_;
  SimulatedClock clock_;
  std::unique_ptr<ContactStream> stream_;
  std::optional<CoupledStorage> storage_;
  std::unique_ptr<ContactFifo> fifo_ = std::make_unique<ContactFifo>();
  ContactSent sent_;
  std::vector<Hand> hands_;
  std::vector<PoseTick> poses_;
  std::vector<PoseTick> trace_;
  PoseTick last_;
  std::unique_ptr<HungTool> hung_;  // null: devices hold the tools
};

}  // namespace

ContactRunReport simulate_contacts(const ResponseDatabase& database,
                                   const ContactRunOptions& options,
                                   const std::atomic<bool>& stop) {
  return ContactRun(database, options).run(stop);
}

bool is_contact_run(const ResponseDatabase& database,
                    const std::vector<std::string>& tools, bool together) {
  const std::vector<const ResponseTable*> tables = tables_of(database, tools);
  const bool sets =
      std::any_of(tables.begin(), tables.end(), [](const ResponseTable* table) {
        return !table->tool.contact.empty();
      });
  if (sets && tables.size() > 1 && !together) {
    throw InputError(
        "a tool of several contacts is rendered alone, or with a second one by "
        "--together");
  }
  return sets || together;
}

}  // namespace palpate
