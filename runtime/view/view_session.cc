#include "runtime/view/view_session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "formats/response/turn_from_z.h"
#include "runtime/view/steered_contact.h"
#include "runtime/view/steered_contacts.h"
#include "runtime/view/view_contact.h"
#include "runtime/view/view_seat.h"

namespace palpate {
namespace {

void check(const ViewSessionOptions& options) {
  if (!(options.fast_hz >= 100.0 && options.fast_hz <= 20000.0)) {
    throw InputError(
        fmt::format("fast rate is {} Hz, must lie in [100, 20000]", options.fast_hz));
  }
  if (!(options.slow_hz >= 1.0 && options.slow_hz <= options.fast_hz)) {
    throw InputError(fmt::format("slow rate is {} Hz, must lie in [1, {}]",
                                 options.slow_hz, options.fast_hz));
  }
  if (!(options.force_max_n > 0.0) || !std::isfinite(options.force_max_n)) {
    throw InputError(fmt::format("largest force is {} N, must be positive and finite",
                                 options.force_max_n));
  }
}

FastProcessConfig process_config(const ViewSessionOptions& options,
                                 const ToolShape& tool, const HeldDevice& held = {}) {
  FastProcessConfig config;
  config.fast.model = options.model;
  config.fast.tool_radius_m = nominal_height_m(tool);
  config.fast.force_max_n = options.force_max_n;
  config.rate_hz = options.fast_hz;
  if (held.device != nullptr) {
    config.rate_hz = held.rate_hz;
    config.wire = held.wire;
    config.speed_max_m_per_s = kHandSpeedMaxMPerS;
  }
  // The slow rate may be set to 1 Hz while this lasts.
  config.stall_s = 1.5;
  config.stall_fault_s = 2.5;
  return config;
}

std::unique_ptr<SteeredBody> steered(const ResponseDatabase& database,
                                     const std::vector<const ResponseTable*>& tables,
                                     const ViewSessionOptions& options) {
  const ResponseTable& first = *tables.front();
  const FastConfig config = process_config(options, first.tool).fast;
  if (tables.size() > 1 || !first.tool.contact.empty()) {
    return std::make_unique<SteeredContacts>(database, tables, config, options.surface);
  }
  return std::make_unique<SteeredContact>(database, first, config, options.surface,
                                          options.growing);
}

}  // namespace

ViewSession::ViewSession(const ResponseDatabase& database,
                         const ViewSessionOptions& options)
    : database_(database),
      options_(options),
      search_(database.body),
      fast_deadlines_(0, options.fast_hz),
      slow_deadlines_(0, options.slow_hz) {
  check(options);
  options_.device.tick_s = 1.0 / options.fast_hz;
  options_.device.force_max_n = options.force_max_n;
  const std::vector<const ResponseTable*> tables = find_tools(database, options.tools);
  body_ = steered(database, tables, options_);
  hands_.resize(tables.size());
  rubs_ = tables.size() == 1 && shows_friction(*tables.front());
  const std::vector<std::int32_t> nodes = nodes_to_begin_over(database, tables);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    seat(hands_[i], *tables[i], nodes[i]);
  }
  start();
}

void ViewSession::seat(SteeredHand& hand, const ResponseTable& table,
                       std::int32_t node) {
  hand.table = &table;
  const Eigen::Vector3d normal = database_.normal.row(node).transpose();
  hand.upright = body_->turns() ? turn_from_z(normal) : Eigen::Quaterniond::Identity();
  hand.start_m = lifted_m(table, hand.upright,
                          database_.body.position_m.row(node).transpose(), normal);
}

std::vector<Device*> ViewSession::seat_devices() {
  devices_.clear();
  std::vector<Device*> devices;
  for (SteeredHand& hand : hands_) {
    hand.holding = false;
    hand.pointer = PointerHand(hand.start_m, hand.upright);
    devices_.push_back(std::make_unique<SimulatedDevice>(
        options_.device, hand.pointer.target(), clock_,
        SimulatedMotion{.position_m = hand.start_m}));
    devices_.back()->open();
    devices.push_back(devices_.back().get());
  }
  if (held_.device != nullptr) {
    devices.front() = held_.device;
  }
  return devices;
}

void ViewSession::start() {
  fast_.reset();
  const std::vector<Device*> devices = seat_devices();
  telemetry_ = std::make_unique<Telemetry>();
  body_->begin();
  fast_ = std::make_unique<FastProcess>(process_config(options_, table().tool, held_),
                                        devices, body_->rendered(),
                                        TickOutputs{.telemetry = telemetry_.get()});
  fast_deadlines_ =
      Deadlines(clock_.now_ns(), is_held() ? held_.rate_hz : options_.fast_hz);
  slow_deadlines_ = Deadlines(clock_.now_ns(), options_.slow_hz);
  latest_ = {};
  latest_.time_ns = clock_.now_ns();
  Eigen::Map<Eigen::Vector3d>(latest_.position_m.data()) = hands_.front().start_m;
  Eigen::Map<Eigen::Vector3d>(latest_.second.position_m.data()) = hands_.back().start_m;
  ticks_.clear();
  friction_ = {};
  slow_updates_ = 0;
}

void ViewSession::reset() {
  start();
}

void ViewSession::hold_by(const HeldDevice& held, std::int64_t now_ns) {
  held_ = held;
  before_run_ns_ = now_ns - clock_.now_ns();
  body_->limit(std::min(options_.force_max_n, held.force_max_n), kRampS);
  start();
}

void ViewSession::release() {
  held_ = {};
  body_->limit(options_.force_max_n, 0.0);
  if (fault() == Fault::kNone) {
    start();
  }
}

void ViewSession::follow(const HandWish& wish) {
  if (wish.hand >= static_cast<int>(hands_.size())) {
    throw InputError(fmt::format("hand {} is not there, {} hold{} what is shown",
                                 wish.hand, hands_.size(),
                                 hands_.size() == 1 ? "s" : ""));
  }
  if (wish.turn && !body_->turns()) {
    throw InputError("a tool of one contact does not turn");
  }
  if (wish.hand < 0) {
    let_go();
    return;
  }
  const auto hand = static_cast<std::size_t>(wish.hand);
  if (!wish.hold) {
    lift(hand);
    return;
  }
  SteeredHand& held = hands_[hand];
  held.holding = true;
  held.pointer.point_at(wish.target_m);
  held.pointer.turn_to(wish.turn.value_or(held.pointer.wanted_turn()));
}

void ViewSession::lift(std::size_t hand) {
  if (hands_[hand].holding) {
    hands_[hand].holding = false;
    hands_[hand].pointer.point_at(clear_of(hand));
  }
}

void ViewSession::let_go() {
  for (std::size_t hand = 0; hand < hands_.size(); ++hand) {
    lift(hand);
  }
}

Eigen::Vector3d ViewSession::clear_of(std::size_t hand) const {
  const SteeredHand& held = hands_[hand];
  if (const std::optional<Channel> in = body_->channel()) {
    return in->entry_m + clearance_m(*held.table) * in->axis;
  }
  const ViewContact near = view_contact(database_, held.table->tool, search_,
                                        held.pointer.target().position_m,
                                        body_->triangle_under(hand, latest_));
  if (near.triangle < 0 || near.normal.isZero()) {
    return held.start_m;
  }
  return lifted_m(*held.table, held.pointer.wanted_turn(), near.point_m, near.normal);
}

void ViewSession::set(const ViewRequest& request) {
  body_->set(request);
  options_.model = request.model.value_or(options_.model);
  if (request.slow_hz) {
    options_.slow_hz = std::min(*request.slow_hz, options_.fast_hz);
    slow_deadlines_ = Deadlines(clock_.now_ns(), options_.slow_hz);
  }
}

void ViewSession::advance(std::int64_t ticks) {
  for (std::int64_t i = 0; i < ticks && fault() == Fault::kNone; ++i) {
    tick();
  }
  trim_ticks();
}

void ViewSession::trim_ticks() {
  if (ticks_.size() > kTicksKept) {
    ticks_.erase(ticks_.begin(),
                 ticks_.end() - static_cast<std::ptrdiff_t>(kTicksKept));
  }
}

// As render_in_turns(): the fast process first, then the slow one where it is due.
void ViewSession::tick() {
  clock_.sleep_until_ns(fast_deadlines_.next_ns());
  const std::int64_t skipped = fast_deadlines_.begin(clock_.now_ns());
  for (SteeredHand& hand : hands_) {
    hand.pointer.advance(1.0 / options_.fast_hz);
  }
  if (!fast_->tick(skipped)) {
    for (const std::unique_ptr<SimulatedDevice>& device : devices_) {
      device->close();
    }
  }
  look_at_tick();
}

void ViewSession::tick_at(std::int64_t now_ns) {
  if (fault() != Fault::kNone) {
    return;
  }
  clock_.sleep_until_ns(run_ns(now_ns));
  // Ticks come when positions do: those that did not come in time were skipped.
  const bool due = clock_.now_ns() >= fast_deadlines_.next_ns();
  static_cast<void>(fast_->tick(due ? fast_deadlines_.begin(clock_.now_ns()) : 0));
  look_at_tick();
  trim_ticks();
}

// The slow process where it is due, and what pages are told.
void ViewSession::look_at_tick() {
  if (rubs_) {
    friction_.add(body_->rendered().friction());
  }
  if (clock_.now_ns() >= slow_deadlines_.next_ns()) {
    static_cast<void>(slow_deadlines_.begin(clock_.now_ns()));
    slow_updates_ += body_->rendered().serve(clock_.now_ns()) ? 1 : 0;
  }
  while (const TickRecord* record = telemetry_->ticks.front()) {
    latest_ = *record;
    ticks_.push_back(*record);
    telemetry_->ticks.pop();
  }
  while (telemetry_->arrivals.front() != nullptr) {
    telemetry_->arrivals.pop();
  }
}

bool ViewSession::holding() const {
  return std::any_of(hands_.begin(), hands_.end(), [](const SteeredHand& hand) {
    return hand.holding;
  });
}

bool ViewSession::touching() const {
  return (latest_.flags & static_cast<unsigned>(TickFlag::kContact)) != 0U;
}

std::vector<const ResponseTable*> ViewSession::hand_tables() const {
  std::vector<const ResponseTable*> tables;
  for (std::size_t i = 0; i < hands_.size() && body_->turns(); ++i) {
    tables.push_back(hands_[i].table);
  }
  return tables;
}

ViewSettings ViewSession::settings() const {
  ViewSettings settings{.model = options_.model,
                        .slow_hz = options_.slow_hz,
                        .fast_hz = is_held() ? held_.rate_hz : options_.fast_hz};
  body_->tell(settings);
  return settings;
}

ViewFrame ViewSession::frame() {
  const RenderReport& r = report();
  ViewFrame frame{.holding = holding(),
                  .fault = name(r.fault),
                  .net_j = r.model_work_j,
                  .now = latest_,
                  .run = {.ticks = r.ticks,
                          .slow_updates = slow_updates_,
                          .starved_ticks = r.starved_ticks,
                          .extrapolated_ticks = r.extrapolated_ticks,
                          .step_p50_ns = r.step_time.percentile_ns(0.5),
                          .step_p99_ns = r.step_time.percentile_ns(0.99),
                          .depth_max_m = r.depth_max_m,
                          .force_max_n = r.force_max_n},
                  .settings = settings()};
  if (!is_held()) {
    const PointerHand& first = hands_.front().pointer;
    frame.hand_m = first.target().position_m;
    frame.pointer_m = first.pointer_m();
  }
  body_->show(hands_, frame);
  if (rubs_) {
    frame.friction =
        view_friction(friction_, database_, table().tool, search_, latest_.triangle);
  }
  return frame;
}

std::vector<TickRecord> ViewSession::take_ticks() {
  return std::exchange(ticks_, {});
}

ViewedBody viewed(const ViewSession& session, std::string name) {
  return {.database = session.database(),
          .table = session.table(),
          .name = std::move(name),
          .device = "",
          .fast_hz = session.fast_hz(),
          .force_max_n = session.options().force_max_n,
          .hands = session.hand_tables()};
}

}  // namespace palpate
