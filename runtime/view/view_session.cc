#include "runtime/view/view_session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/hand/press_site.h"

namespace palpate {
namespace {

const ResponseTable& one_contact(const ResponseTable& table) {
  if (!table.tool.contact.empty()) {
    throw InputError(
        fmt::format("tool {:?} has {} contacts: a session of contacts renders it",
                    table.tool.name, table.tool.contact.radius_m.size()));
  }
  return table;
}

// Clear of the body: above touch by the deepest curve, at least 5 mm.
Eigen::Vector3d lifted_m(const ResponseTable& table, const Eigen::Vector3d& point_m,
                         const Eigen::Vector3d& normal) {
  return point_m +
         (drawn_height_m(table.tool, normal) + std::max(0.005, table.depth_max_m())) *
             normal;
}

// Over a node to press; without responses yet over the highest one.
Eigen::Vector3d above_start(const ResponseDatabase& database,
                            const ResponseTable& table) {
  Eigen::Index highest = 0;
  database.body.position_m.col(2).maxCoeff(&highest);
  const std::int32_t node = table.depth_m.empty()
                                ? static_cast<std::int32_t>(highest)
                                : node_to_press(database, table, std::nullopt);
  return lifted_m(table, database.body.position_m.row(node).transpose(),
                  database.normal.row(node).transpose());
}

FastProcessConfig process_config(const ViewSessionOptions& options,
                                 const ToolShape& tool) {
  FastProcessConfig config;
  config.fast.model = options.model;
  config.fast.tool_radius_m = nominal_height_m(tool);
  config.fast.force_max_n = options.force_max_n;
  config.rate_hz = options.fast_hz;
  // The slow rate may be set to 1 Hz while this lasts.
  config.stall_s = 1.5;
  config.stall_fault_s = 2.5;
  return config;
}

}  // namespace

void check_rates(double fast_hz, double slow_hz, double force_max_n) {
  if (!(fast_hz >= 100.0 && fast_hz <= 20000.0)) {
    throw InputError(
        fmt::format("fast rate is {} Hz, must lie in [100, 20000]", fast_hz));
  }
  if (!(slow_hz >= 1.0 && slow_hz <= fast_hz)) {
    throw InputError(
        fmt::format("slow rate is {} Hz, must lie in [1, {}]", slow_hz, fast_hz));
  }
  if (!(force_max_n > 0.0) || !std::isfinite(force_max_n)) {
    throw InputError(
        fmt::format("largest force is {} N, must be positive and finite", force_max_n));
  }
}

ViewSession::ViewSession(const ResponseDatabase& database,
                         const ViewSessionOptions& options)
    : database_(database),
      table_(one_contact(find_tool(database, options.tool))),
      options_(options),
      stream_(database, table_),
      adjusted_(options.growing != nullptr ? *options.growing : stream_),
      dents_(table_),
      start_m_(above_start(database, table_)),
      hand_(start_m_),
      fast_deadlines_(0, options.fast_hz),
      slow_deadlines_(0, options.slow_hz) {
  check_rates(options.fast_hz, options.slow_hz, options.force_max_n);
  options_.device.tick_s = 1.0 / options.fast_hz;
  options_.device.force_max_n = options.force_max_n;
  start(start_m_);
}

void ViewSession::start(const Eigen::Vector3d& at_m) {
  fast_.reset();
  holding_ = false;
  hand_ = PointerHand(at_m);
  device_ = std::make_unique<SimulatedDevice>(options_.device, hand_.target(), clock_,
                                              SimulatedMotion{.position_m = at_m});
  telemetry_ = std::make_unique<Telemetry>();
  device_->open();
  const FastProcessConfig config = process_config(options_, table_.tool);
  body_ = std::make_unique<OneContact>(config.fast, adjusted_);
  body_->begin_with(options_.surface);
  fast_ = std::make_unique<FastProcess>(config, *device_, *body_,
                                        TickOutputs{.telemetry = telemetry_.get()});
  fast_deadlines_ = Deadlines(clock_.now_ns(), options_.fast_hz);
  slow_deadlines_ = Deadlines(clock_.now_ns(), options_.slow_hz);
  latest_ = {};
  latest_.time_ns = clock_.now_ns();
  latest_.position_m = {at_m.x(), at_m.y(), at_m.z()};
  ticks_.clear();
  slow_updates_ = 0;
}

void ViewSession::hold(const Eigen::Vector3d& pointer_m) {
  holding_ = true;
  hand_.point_at(pointer_m);
}

void ViewSession::let_go() {
  if (holding_) {
    holding_ = false;
    hand_.point_at(clear_of(hand_.target().position_m));
  }
}

void ViewSession::heed(const HandWish& wish) {
  if (wish.hand > 0) {
    throw InputError(
        fmt::format("hand {} is not there, one hand holds the tool", wish.hand));
  }
  if (wish.turn) {
    throw InputError("a tool of one contact does not turn");
  }
  if (wish.hold) {
    hold(wish.target_m);
  } else {
    let_go();
  }
}

void ViewSession::set(const ViewRequest& request) {
  if (request.coupled) {
    throw InputError("one contact couples with no other");
  }
  if (request.model) {
    use(*request.model);
  }
  if (request.slow_hz) {
    set_slow_hz(*request.slow_hz);
  }
  if (request.stiffness_scale) {
    set_stiffness_scale(*request.stiffness_scale);
  }
  if (request.friction || request.database_friction) {
    set_friction(request.friction);
  }
}

void ViewSession::use(LocalModel model) {
  options_.model = model;
  body_->use(model);
}

void ViewSession::set_slow_hz(double slow_hz) {
  options_.slow_hz = std::min(slow_hz, options_.fast_hz);
  slow_deadlines_ = Deadlines(clock_.now_ns(), options_.slow_hz);
}

void ViewSession::set_stiffness_scale(double scale) {
  adjusted_.set_stiffness_scale(scale);
}

void ViewSession::set_friction(std::optional<double> friction) {
  adjusted_.set_friction(friction);
}

void ViewSession::advance(std::int64_t ticks) {
  for (std::int64_t i = 0; i < ticks && report().fault == Fault::kNone; ++i) {
    tick();
  }
  if (ticks_.size() > kTicksKept) {
    ticks_.erase(ticks_.begin(),
                 ticks_.end() - static_cast<std::ptrdiff_t>(kTicksKept));
  }
}

// As render_in_turns(): the fast process first, then the slow one where it is due.
void ViewSession::tick() {
  clock_.sleep_until_ns(fast_deadlines_.next_ns());
  const std::int64_t skipped = fast_deadlines_.begin(clock_.now_ns());
  hand_.advance(1.0 / options_.fast_hz);
  if (!fast_->tick(skipped)) {
    device_->close();
  }
  if (clock_.now_ns() >= slow_deadlines_.next_ns()) {
    static_cast<void>(slow_deadlines_.begin(clock_.now_ns()));
    slow_updates_ += body_->serve(clock_.now_ns()) ? 1 : 0;
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

void ViewSession::reset() {
  start(start_m_);
}

Eigen::Vector3d ViewSession::clear_of(const Eigen::Vector3d& from_m) const {
  const ViewContact near =
      view_contact(database_, table_.tool, stream_.search(), from_m, latest_.triangle);
  return near.triangle < 0 ? start_m_ : lifted_m(table_, near.point_m, near.normal);
}

ViewContact ViewSession::contact() const {
  const Eigen::Map<const Eigen::Vector3d> tool(latest_.position_m.data());
  return view_contact(database_, table_.tool, stream_.search(), tool, latest_.triangle);
}

bool ViewSession::touching() const {
  return (latest_.flags & static_cast<unsigned>(TickFlag::kContact)) != 0U;
}

ViewFrame ViewSession::frame() {
  const RenderReport& r = report();
  return {.holding = holding_,
          .hand_m = hand_.target().position_m,
          .pointer_m = hand_.pointer_m(),
          .fault = name(r.fault),
          .net_j = net_work_j(),
          .now = latest_,
          .contact = contact(),
          .dents = dents(),
          .run = {.ticks = r.ticks,
                  .slow_updates = slow_updates_,
                  .starved_ticks = r.starved_ticks,
                  .extrapolated_ticks = r.extrapolated_ticks,
                  .step_p50_ns = r.step_time.percentile_ns(0.5),
                  .step_p99_ns = r.step_time.percentile_ns(0.99),
                  .depth_max_m = r.depth_max_m,
                  .force_max_n = r.force_max_n},
          .settings = {.model = options_.model,
                       .slow_hz = options_.slow_hz,
                       .fast_hz = options_.fast_hz,
                       .stiffness_scale = stiffness_scale(),
                       .friction = friction()}};
}

std::vector<TickRecord> ViewSession::take_ticks() {
  return std::exchange(ticks_, {});
}

}  // namespace palpate
