#include "runtime/view/page_device.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/hand/press_site.h"
#include "runtime/slow/field_stiffness.h"

namespace palpate {
namespace {

constexpr InverseVersion kLatest{3, 5};
constexpr InverseVersion kBefore{3, 4};
constexpr double kHandNPerM = 300.0;  // of a script that only says where

RenderedStiffness scaled(RenderedStiffness stiffness, double scale) {
  for (double* const k : {&stiffness.normal_n_per_m, &stiffness.friction_n_per_m,
                          &stiffness.shaft_n_per_m, &stiffness.lateral_n_per_m}) {
    *k *= scale;
  }
  return stiffness;
}

// With the page's friction in the database's place, if it has one.
RenderedStiffness stiffness_of(const ViewSession& session, const ViewSettings& settings,
                               double force_max_n) {
  ResponseTable table = session.table();
  if (settings.friction) {
    std::fill(table.friction.begin(), table.friction.end(), *settings.friction);
  }
  return model_stiffness(session.database(), table, settings.model, force_max_n);
}

}  // namespace

// The device as the fast process sees it: what the latest state said, and what the next
// command will say.
class PageDevice::Fed : public Device {
 public:
  explicit Fed(const DeviceLimits& limits) : limits_(limits) {}
  DeviceReading latest;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();

  [[nodiscard]] std::string name() const override { return "haply-inverse"; }
  [[nodiscard]] DeviceLimits limits() const override { return limits_; }
  void open() override {}
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override {
    reading = latest;
    return DeviceStatus::kOk;
  }
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& wanted_n) noexcept override {
    force_n = wanted_n;
    return DeviceStatus::kOk;
  }
  void close() noexcept override { force_n.setZero(); }

 private:
  DeviceLimits limits_;
};

PageDevice::PageDevice(ViewSession& session, InverseConfig config)
    : session_(session), config_(std::move(config)) {
  config_.tell = [this](const std::string& what) {
    told_ = what;
  };
}

void PageDevice::ask(const ViewRequest& request) {
  if (!session_.hand_tables().empty()) {
    throw InputError(
        "a device presses with a tool of one contact in a page: palpate "
        "view --device renders several");
  }
  const ViewSettings settings = session_.settings();
  if (!passive(settings.model)) {
    throw InputError(
        fmt::format("the model \"{}\" can push a hand by itself: a device "
                    "in a page renders passive models",
                    name(settings.model)));
  }
  if (active()) {
    throw InputError("a device presses already");
  }
  if (session_.fault() != Fault::kNone) {
    session_.reset();
  }
  stiffness_ = stiffness_of(session_, settings, config_.force_max_n);
  place(request);
  limit_ = request.limit;
  respelled_ = false;
  told_.clear();
  service_.emplace(config_);
  test_.reset();
  asked_ns_ = -1;
  late_.reset();
  heard_ns_ = 0;
  exchanges_ = {};
  phase_ = Phase::kConnecting;
  detail_ = fmt::format("looking for Haply's service at port {}", config_.port);
}

// Over the node that the page points at, or the nearest one that answers.
void PageDevice::place(const ViewRequest& request) {
  const ResponseDatabase& database = session_.database();
  if (request.node >= database.body.position_m.rows()) {
    throw InputError("\"node\" is none of the body");
  }
  const std::int32_t node =
      node_to_press(database, session_.table(),
                    database.body.position_m.row(request.node).transpose());
  const HandScript script =
      script_at(database, session_.table(), node, config_.force_max_n, 1.0, kHandNPerM);
  auto fed = std::make_unique<Fed>(inverse_limits(config_));
  fed_ = fed.get();
  placed_ = std::make_unique<PlacedDevice>(
      std::move(fed), placement_over(script, inverse_rest_m(), request.right));
}

void PageDevice::let_go(std::string_view why) {
  if (!active()) {
    return;
  }
  if (phase_ != Phase::kConnecting) {
    send(Eigen::Vector3d::Zero(), sent_ns_);
  }
  phase_ = Phase::kOff;
  detail_ = why;
  if (session_.is_held()) {
    session_.release();
  }
  if (before_) {
    session_.set({.stiffness_scale = std::exchange(before_, std::nullopt)});
  }
}

void PageDevice::send(const Eigen::Vector3d& force_n, std::int64_t now_ns,
                      std::string_view profile) {
  command_ = service_->command(force_n, profile);
  sent_ns_ = now_ns;
}

std::string PageDevice::take_command() {
  return std::exchange(command_, {});
}

void PageDevice::hear(std::string_view text, const HeardAt& at) {
  if (!active()) {
    return;
  }
  if (phase_ == Phase::kConnecting) {
    greet(text, at.now_ns);
    return;
  }
  const char* const why = at.asked ? service_->take(text) : service_->take_unasked();
  if (why != nullptr) {
    let_go(why);
  } else if (service_->missing()) {
    late_ = at;
  } else if (at.asked) {
    go_on(at);
  }
}

// After the state that answers the latest command.
void PageDevice::go_on(const HeardAt& at) {
  static_cast<void>(service_->exchanged(true));
  if (phase_ == Phase::kOn) {
    tick(at);
    return;
  }
  if (heard_ns_ > 0) {
    const double passed_s = seconds_in(at.now_ns - heard_ns_);
    ++exchanges_.count;
    exchanges_.sum_s += passed_s;
    exchanges_.squares_s2 += passed_s * passed_s;
  }
  heard_ns_ = at.now_ns;
  if (test_->passed()) {
    begin(at.now_ns);
  } else {
    test(service_->position_m(), made_n(at), at.now_ns);
  }
}

void PageDevice::hear_event(std::string_view text) {
  // Before the first state nobody knows whose events are meant.
  if (phase_ == Phase::kTesting || phase_ == Phase::kOn) {
    if (const char* why = service_->take_event(text)) {
      let_go(why);
    }
  }
}

void PageDevice::greet(std::string_view text, std::int64_t now_ns) {
  try {
    service_->greet(text, force_key(kLatest));
  } catch (const DeviceError& error) {
    let_go(error.what());
    return;
  }
  test_.emplace("the device", SignTestOptions{});
  phase_ = Phase::kTesting;
  detail_ = fmt::format(
      "hold the tool loosely in the middle: it is pushed to and fro "
      "with {} N, to feel that its motors push the right way",
      SignTestOptions{}.force_n);
  send(Eigen::Vector3d::Zero(), now_ns, config_.profile);
}

void PageDevice::test(const std::optional<Eigen::Vector3d>& position_m,
                      const Eigen::Vector3d& acted_n, std::int64_t now_ns) {
  try {
    send(test_->next(position_m, acted_n, now_ns), now_ns);
  } catch (const DeviceError& error) {
    constexpr double kSlowS = 0.01;  // then few forces have acted at all
    const double hold_s = measured().hold_s;
    if (hold_s > kSlowS && test_->felt_nothing()) {
      let_go(
          fmt::format("messages of the device take {:.0f} ms here, too long to press "
                      "with: is this computer busy?",
                      1e3 * hold_s));
      return;
    }
    if (respelled_ || !test_->felt_nothing()) {
      let_go(error.what());
      return;
    }
    // Versions before 3.5 may not know the force that was asked for.
    respelled_ = true;
    service_->speak(force_key(kBefore));
    test_.emplace("the device", SignTestOptions{});
    send(Eigen::Vector3d::Zero(), now_ns);
  }
}

// A force begins to act one exchange after its position, beside the service's own.
DeviceLimits PageDevice::measured() const {
  DeviceLimits limits = inverse_limits(config_);
  const double exchange_s =  // mean over time
      exchanges_.sum_s > 0.0 ? exchanges_.squares_s2 / exchanges_.sum_s : 0.0;
  limits.hold_s = std::max(limits.hold_s, exchange_s);
  limits.delay_s += exchange_s;
  return limits;
}

std::string PageDevice::refusal(double stiffness_scale,
                                const DeviceLimits& limits) const {
  return why_not_renderable(scaled(stiffness_, stiffness_scale),
                            stability_bounds(limits, limits.hold_s), limits,
                            limits.hold_s);
}

// False where the device was let go of instead.
bool PageDevice::soften(const DeviceLimits& limits) {
  const double scale = session_.settings().stiffness_scale.value_or(1.0);
  const std::string why = refusal(scale, limits);
  if (why.empty()) {
    return true;
  }
  const double renderable =
      stability_bounds(limits, limits.hold_s).renderable_n_per_m() /
      stiffness_.largest_n_per_m();
  if (renderable < ViewRanges::kStiffnessMin) {
    let_go(fmt::format("the device cannot render this: {}", why));
    return false;
  }
  if (!limit_) {
    let_go(
        fmt::format("the device cannot render this: {}; a stiffness of {:.2g} or a "
                    "limit would do",
                    why, renderable));
    return false;
  }
  before_ = scale;
  session_.set({.stiffness_scale = renderable});
  return true;
}

WireLimits PageDevice::wire(double stiffness_scale) const {
  const DeviceLimits limits = measured();
  return {.damping_n_s_per_m = limits.damping_n_s_per_m,
          .stiffness_n_per_m = stiffness_scale * stiffness_.largest_n_per_m(),
          .delay_s = limits.delay_s};
}

void PageDevice::begin(std::int64_t now_ns) {
  const DeviceLimits limits = measured();
  if (!soften(limits)) {
    return;
  }
  phase_ = Phase::kOn;
  detail_ = told_;
  session_.hold_by({.device = placed_.get(),
                    .wire = wire(session_.settings().stiffness_scale.value_or(1.0)),
                    .rate_hz = static_cast<double>(exchanges_.count) / exchanges_.sum_s,
                    .force_max_n = limits.force_max_n},
                   now_ns);
  send(Eigen::Vector3d::Zero(), now_ns);
}

// Of the command that a state answers.
Eigen::Vector3d PageDevice::made_n(const HeardAt& at) const {
  return at.withheld ? Eigen::Vector3d::Zero() : service_->sent_n();
}

void PageDevice::tick(const HeardAt& at) {
  fed_->latest = {.position_m = service_->position_m(),
                  .time_ns = session_.run_ns(at.received_ns),
                  .withheld_n = fed_->force_n - made_n(at),
                  .read_ns = session_.run_ns(at.now_ns)};
  session_.tick_at(at.now_ns);
  if (session_.fault() != Fault::kNone) {
    let_go(fmt::format("let go of after a fault, {}: reset begins anew",
                       name(session_.fault())));
    return;
  }
  send(fed_->force_n, at.now_ns);
}

void PageDevice::watch(std::int64_t now_ns) {
  asked_ns_ = asked_ns_ < 0 ? now_ns : asked_ns_;
  if (phase_ == Phase::kConnecting) {
    if (now_ns - asked_ns_ > nanoseconds_in(config_.open_s)) {
      let_go(
          fmt::format("Haply's service did not answer at port {} within {} s: is it "
                      "running?",
                      config_.port, config_.open_s));
    }
    return;
  }
  if (!active()) {
    return;
  }
  if (late_ && now_ns - late_->now_ns > nanoseconds_in(InverseSession::kQuietS)) {
    HeardAt at = *std::exchange(late_, std::nullopt);
    at.now_ns = now_ns;
    go_on(at);
    return;
  }
  if (now_ns - sent_ns_ <= nanoseconds_in(config_.answer_s)) {
    return;
  }
  if (const char* why = service_->exchanged(false)) {
    let_go(why);
  } else if (phase_ == Phase::kTesting) {
    test(std::nullopt, Eigen::Vector3d::Zero(), now_ns);
  } else {
    send(Eigen::Vector3d::Zero(), now_ns);
  }
}

void PageDevice::set(const ViewRequest& request) {
  if (request.model || request.friction || request.database_friction ||
      request.coupled) {
    throw InputError(
        "model and friction stay while a device presses: let go of it first");
  }
  const double scale = request.stiffness_scale.value_or(
      session_.settings().stiffness_scale.value_or(1.0));
  if (phase_ == Phase::kOn) {
    if (const std::string why = refusal(scale, measured()); !why.empty()) {
      throw InputError(fmt::format("the device cannot render this: {}", why));
    }
    session_.watch_wire(wire(scale));
  }
  session_.set(request);
}

ViewDeviceShown PageDevice::shown() const {
  ViewDeviceShown shown{.detail = detail_, .force_max_n = config_.force_max_n};
  switch (phase_) {
    case Phase::kOff:
      break;
    case Phase::kConnecting:
      shown.phase = "connecting";
      break;
    case Phase::kTesting:
      shown.phase = "testing";
      break;
    case Phase::kOn:
      shown.phase = "on";
      shown.hz = static_cast<double>(session_.report().ticks) /
                 std::max(session_.report().duration_s, 1e-3);
      break;
  }
  return shown;
}

}  // namespace palpate
