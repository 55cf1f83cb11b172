#include "runtime/view/contact_session.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/contact_set.h"
#include "formats/response/tool_support.h"
#include "formats/response/turn_from_z.h"
#include "runtime/hand/press_site.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/view/view_contact.h"
#include "runtime/view/view_session.h"

namespace palpate {
namespace {

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

// How far the tool reaches from its reference point towards `down` [m].
double reach_m(const ToolShape& tool, const Eigen::Quaterniond& turn,
               const Eigen::Vector3d& down) {
  if (tool.contact.empty()) {
    return nominal_height_m(tool);
  }
  double most = 0.0;
  for (std::size_t i = 0; i < tool.contact.radius_m.size(); ++i) {
    const Eigen::Vector3d centre =
        tool.contact.point_m.row(static_cast<Eigen::Index>(i)).transpose();
    most = std::max(most, tool.contact.radius_m[i] + down.dot(turn * centre));
  }
  return most;
}

Eigen::Quaterniond upright(const Eigen::Vector3d& normal) {
  return turn_from_z(normal);
}

// As far towards the goal as a wrist turns in a tick.
Eigen::Quaterniond turned(const Eigen::Quaterniond& now, const Eigen::Quaterniond& goal,
                          double dt_s) {
  const double angle = now.angularDistance(goal);
  if (!(angle > 1e-9)) {
    return now;
  }
  const double follow = 1.0 - std::exp(-ContactSession::kTurnFollowPerS * dt_s);
  const double most = ContactSession::kTurnRadPerS * dt_s / angle;
  return now.slerp(std::min(follow, most), goal).normalized();
}

// How far from each other two hands begin.
double apart_m(const std::vector<const ResponseTable*>& tables) {
  double sum = 0.0;
  for (const ResponseTable* table : tables) {
    for (const double side : {-1.0, 1.0}) {
      sum +=
          0.75 * reach_m(table->tool, Eigen::Quaterniond::Identity(), {side, 0.0, 0.0});
    }
  }
  return sum;
}

// The node nearest to where a second hand is apart_m beside the first, on the side
// where the body has one.
std::int32_t node_beside(const ResponseDatabase& database, const ResponseTable& table,
                         std::int32_t first, double apart_m) {
  const Eigen::Vector3d at_m = database.body.position_m.row(first).transpose();
  const Eigen::Quaterniond frame = upright(database.normal.row(first).transpose());
  std::int32_t best = -1;
  double least_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& side :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0),
        Eigen::Vector3d(0, -1, 0)}) {
    const Eigen::Vector3d wanted_m = at_m + apart_m * (frame * side);
    const std::int32_t node = node_to_press(database, table, wanted_m);
    const double off_m =
        (database.body.position_m.row(node).transpose() - wanted_m).norm();
    if (off_m < least_m) {
      best = node;
      least_m = off_m;
    }
  }
  return best;
}

FastConfig fast_config(const ContactSessionOptions& options) {
  FastConfig config;
  config.model = LocalModel::kPotential;
  config.force_max_n = options.force_max_n;
  return config;
}

}  // namespace

ContactSession::ContactSession(const ResponseDatabase& database,
                               const ContactSessionOptions& options)
    : database_(database),
      tables_(tables_of(database, options.tools)),
      options_(options),
      adjusted_(database, tables_),
      search_(database.body),
      hands_(tables_.size()),
      fast_deadlines_(0, options.fast_hz),
      slow_deadlines_(0, options.slow_hz) {
  check_rates(options.fast_hz, options.slow_hz, options.force_max_n);
  options_.device.tick_s = 1.0 / options.fast_hz;
  options_.device.force_max_n = options.force_max_n;
  storage_.emplace(adjusted_.set(), fast_config(options_));
  const std::int32_t first = node_to_press(database, *tables_.front(), std::nullopt);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const std::int32_t node =
        i == 0 ? first : node_beside(database, *tables_[i], first, apart_m(tables_));
    place(hands_[i], *tables_[i], node);
    add_dents(*tables_[i]);
  }
  start();
}

// In the order of coupled_set()'s tables of responses.
void ContactSession::add_dents(const ResponseTable& tool) {
  const std::size_t radii =
      tool.tool.contact.empty() ? 1 : distinct_radii(tool.tool.contact).size();
  for (std::size_t radius = 0; radius < radii; ++radius) {
    dents_.emplace_back(table_of_radius(database_, tool, radius));
  }
}

void ContactSession::place(Held& hand, const ResponseTable& table, std::int32_t node) {
  hand.table = &table;
  hand.upright = upright(database_.normal.row(node).transpose());
  hand.goal = hand.upright;
  hand.start_m = clear_of(hand, database_.body.position_m.row(node).transpose());
}

void ContactSession::start() {
  command_ = {};
  run_ = {};
  latest_ = {};
  for (Held& hand : hands_) {
    hand.holding = false;
    hand.pointer = PointerHand(hand.start_m);
    hand.turn = hand.goal;
    hand.device = std::make_unique<SimulatedDevice>(
        options_.device, hand.pointer.target(), clock_,
        SimulatedMotion{.position_m = hand.start_m});
    hand.device->open();
  }
  restart(storage_->state());
  adjusted_.forget();
  clear_fifo();
  fast_deadlines_ = Deadlines(clock_.now_ns(), options_.fast_hz);
  slow_deadlines_ = Deadlines(clock_.now_ns(), options_.slow_hz);
  latest_.time_ns = clock_.now_ns();
  pose_ = sampled();
  Eigen::Map<Eigen::Vector3d>(latest_.position_m.data()) = pose_[0].position_m;
  ticks_.clear();
  loads_.clear();
}

void ContactSession::clear_fifo() {
  while (fifo_->front() != nullptr) {
    fifo_->pop();
  }
}

void ContactSession::reset() {
  for (Held& hand : hands_) {
    hand.goal = hand.upright;
  }
  start();
}

void ContactSession::heed(const HandWish& wish) {
  if (wish.hand >= static_cast<int>(hands_.size())) {
    throw InputError(fmt::format("hand {} is not there, hands count from 0 to {}",
                                 wish.hand, hands_.size() - 1));
  }
  if (wish.hand < 0) {
    let_go();
    return;
  }
  Held& hand = hands_[static_cast<std::size_t>(wish.hand)];
  if (!wish.hold) {
    lift(hand);
    return;
  }
  hand.holding = true;
  hand.pointer.point_at(wish.target_m);
  hand.goal = wish.turn.value_or(hand.goal);
}

void ContactSession::lift(Held& hand) {
  if (hand.holding) {
    hand.holding = false;
    hand.pointer.point_at(clear_of(hand, hand.pointer.target().position_m));
  }
}

void ContactSession::let_go() {
  for (Held& hand : hands_) {
    lift(hand);
  }
}

// Above touch by the deepest curve, at least 5 mm.
Eigen::Vector3d ContactSession::clear_of(const Held& hand,
                                         const Eigen::Vector3d& from_m) const {
  const ViewContact near =
      view_contact(database_, hand.table->tool, search_, from_m, -1);
  if (near.triangle < 0 || near.normal.isZero()) {
    return hand.start_m;
  }
  const double height_m = reach_m(hand.table->tool, hand.goal, -near.normal) +
                          std::max(0.005, hand.table->depth_max_m());
  return near.point_m + height_m * near.normal;
}

void ContactSession::set(const ViewRequest& request) {
  if (request.model && *request.model != LocalModel::kPotential) {
    throw InputError("several contacts are rendered by the model \"potential\" alone");
  }
  if (request.slow_hz) {
    options_.slow_hz = std::min(*request.slow_hz, options_.fast_hz);
    slow_deadlines_ = Deadlines(clock_.now_ns(), options_.slow_hz);
  }
  if (request.stiffness_scale) {
    adjusted_.set_stiffness_scale(*request.stiffness_scale);
  }
  if (request.friction || request.database_friction) {
    adjusted_.set_friction(request.friction);
  }
  if (request.coupled) {
    adjusted_.set_coupled(*request.coupled);
  }
  if (request.stiffness_scale || request.friction || request.database_friction ||
      request.coupled) {
    clear_fifo();
    adjusted_.renew(storage_->state());
  }
}

void ContactSession::advance(std::int64_t ticks) {
  for (std::int64_t i = 0; i < ticks && fault() == Fault::kNone; ++i) {
    tick();
  }
  if (ticks_.size() > kTicksKept) {
    const auto surplus = static_cast<std::ptrdiff_t>(ticks_.size() - kTicksKept);
    ticks_.erase(ticks_.begin(), ticks_.begin() + surplus);
    loads_.erase(loads_.begin(), loads_.begin() + surplus);
  }
}

PortPoses ContactSession::sampled() {
  PortPoses pose;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    DeviceReading reading;
    (void)hands_[i].device->read(reading);
    pose[i] = {reading.position_m, hands_[i].turn.toRotationMatrix()};
  }
  return pose;
}

// The fast process, then the slow one where it is due.
void ContactSession::tick() {
  const double dt_s = 1.0 / options_.fast_hz;
  clock_.sleep_until_ns(fast_deadlines_.next_ns());
  (void)fast_deadlines_.begin(clock_.now_ns());
  for (Held& hand : hands_) {
    hand.pointer.advance(dt_s);
    hand.turn = turned(hand.turn, hand.goal, dt_s);
  }
  pose_ = sampled();
  while (const ContactElement* message = fifo_->front()) {
    accept(storage_->state(), *message);
    fifo_->pop();
  }
  command_ = step(storage_->state(), {pose_, clock_.now_ns()}, dt_s);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    (void)hands_[i].device->write(command_.wrench[i].force_n);
    if (command_.fault != 0) {
      hands_[i].device->close();
    }
  }
  account_tick();
  if (clock_.now_ns() >= slow_deadlines_.next_ns()) {
    serve();
  }
}

void ContactSession::serve() {
  (void)slow_deadlines_.begin(clock_.now_ns());
  ContactToolState at =
      contact_tool_state(storage_->state(), static_cast<std::uint64_t>(run_.ticks));
  (void)adjusted_.update(at, clock_.now_ns(), *fifo_);
  ++run_.slow_updates;
}

void ContactSession::account_tick() {
  const WrenchCommand& c = command_;
  ViewLoads loads;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    loads.force_n[i] = c.wrench[i].force_n.norm();
    loads.torque_n_m[i] = c.wrench[i].torque_n_m.norm();
    run_.force_max_n = std::max(run_.force_max_n, loads.force_n[i]);
  }
  latest_ = {
      .tick = run_.ticks,
      .time_ns = clock_.now_ns(),
      .depth_m = c.depth_m,
      .work_j = account().work_j,
      .stored_j = c.stored_j,
      .tank_j = c.tank_j,
      .dissipated_j = c.dissipated_j,
      .relaxed_shift_m = c.relaxed_shift_m,
      .flags = static_cast<std::uint8_t>(
          (c.in_contact ? static_cast<unsigned>(TickFlag::kContact) : 0U) |
          (c.starved ? static_cast<unsigned>(TickFlag::kStarved) : 0U) |
          (c.extrapolated ? static_cast<unsigned>(TickFlag::kExtrapolated) : 0U)),
      .fault = c.fault};
  Eigen::Map<Eigen::Vector3d>(latest_.position_m.data()) = pose_[0].position_m;
  Eigen::Map<Eigen::Vector3d>(latest_.force_n.data()) = c.wrench[0].force_n;
  ticks_.push_back(latest_);
  loads_.push_back(loads);
  ++run_.ticks;
  run_.starved_ticks += c.starved ? 1 : 0;
  run_.extrapolated_ticks += c.extrapolated ? 1 : 0;
  run_.depth_max_m = std::max(run_.depth_max_m, c.depth_m);
}

bool ContactSession::holding() const {
  return std::any_of(hands_.begin(), hands_.end(), [](const Held& hand) {
    return hand.holding;
  });
}

std::vector<TickRecord> ContactSession::take_ticks() {
  return std::exchange(ticks_, {});
}

}  // namespace palpate
