#include "runtime/c_api/host_contacts.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Geometry>

#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

PortPose pose_of(const HostSample& sample) {
  PortPose pose;
  pose.position_m = sample.position_m;
  const double length = sample.quaternion.stableNorm();
  if (!sample.quaternion.allFinite()) {  // a fault of the step
    pose.rotation.setConstant(std::numeric_limits<double>::quiet_NaN());
  } else if (length > 0.0) {
    const Eigen::Vector4d unit = sample.quaternion / length;
    pose.rotation =
        Eigen::Quaterniond(unit.w(), unit.x(), unit.y(), unit.z()).toRotationMatrix();
  }
  return pose;
}

// The contact that carries most, for the state's one.
FastContact foremost(const CoupledState& state) {
  FastContact at;
  at.time_ns = state.latest.time_ns;
  at.tool_m = state.latest.pose[0].position_m;
  at.in_contact = state.in_contact;
  double most = -1.0;
  for (int i = 0; i < state.set.count; ++i) {
    const CoupledContactPlace place = contact_place(state, i);
    if (place.triangle >= 0 && place.force_n.norm() > most) {
      most = place.force_n.norm();
      at.point_m = place.point_m;
      at.normal = place.normal;
      at.triangle = place.triangle;
      at.starved = place.starved;
    }
  }
  return at;
}

}  // namespace

HostContacts::HostContacts(const CoupledSet& set, const FastConfig& fast, double tick_s,
                           double stall_s)
    : storage_(set, fast),
      tick_s_(tick_s),
      stall_s_(stall_s),
      exchange_(std::make_unique<ContactExchange>()) {}

HostTick HostContacts::step(std::span<const HostSample> samples) noexcept {
  CoupledState& state = storage_.state();
  const double dt_s = samples[0].dt_s == 0.0 ? tick_s_ : samples[0].dt_s;
  for (int taken = 0; taken < kElementsATick; ++taken) {
    const ContactElement* message = exchange_->elements.front();
    if (message == nullptr) {
      break;
    }
    accept(state, *message);
    exchange_->elements.pop();
    silent_s_ = 0.0;
  }
  if (dt_s > 0.0 && dt_s <= 1.0) {  // any other is a fault of the step
    time_ns_ += std::llround(dt_s * kNanosecondsPerSecond);
    silent_s_ += dt_s;
  }
  if (state.in_contact && silent_s_ > stall_s_) {
    raise_fault(state, Fault::kSlowStalled);
  }
  PoseSample sample{.pose = {}, .time_ns = time_ns_};
  for (std::size_t hand = 0; hand < samples.size(); ++hand) {
    sample.pose[hand] = pose_of(samples[hand]);
  }
  HostTick tick;
  tick.command = samples[0].torque_felt ? palpate::step(state, sample, dt_s)
                                        : step_unturned(state, sample, dt_s);
  tick.contact = foremost(state);
  tick.work_j = account_of(state).work_j;
  tick.ticks = ++ticks_;
  if (tick.command.fault == 0) {
    exchange_->tool.write(contact_tool_state(state, ++sequence_));
  }
  return tick;
}

void HostContacts::reset() noexcept {
  restart(storage_.state());
  silent_s_ = 0.0;
  ticks_ = 0;
  while (exchange_->elements.front() != nullptr) {
    exchange_->elements.pop();
  }
}

}  // namespace palpate
