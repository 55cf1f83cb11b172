#include "runtime/contacts/virtual_tool.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Geometry>

#include "runtime/contacts/wrench_vector.h"

namespace palpate {
namespace {

// Most that a step of the coupling's fixed point may leave of its error, without the
// body: that has as much again.
constexpr Real kContraction = 0.5;
// Turns below this are rounding: |q_v|^2.
constexpr Real kNoTurn = rounding(1e-30, 1e-13);

// The body's energy as a function of one port's pose.
struct OnePort {
  VirtualTool& held;
  CoupledState& state;
  PortPoses pose;
  std::size_t port;
};

Real energy_j(void* of, const PortPose& pose, Wrench* wrench) {
  auto& self = *static_cast<OnePort*>(of);
  self.pose[self.port] = pose;
  const Real energy = potential_j(self.state, self.held.moved, self.pose);
  if (wrench != nullptr) {
    *wrench = wrenches(self.held.moved, self.state.set, self.pose)[self.port];
  }
  return energy;
}

// Whether the longest tick of a mass on a spring and a damper can be solved.
bool is_heavy_enough(Real mass, Real spring, Real damper) {
  const Real h = kVirtualTickMaxS;
  return h * (Real(0.25) * h * spring + Real(0.5) * damper) <= kContraction * mass;
}

std::size_t ports(const CoupledState& state) {
  return static_cast<std::size_t>(state.set.ports);
}

bool is_sound(const CoupledState& state, const PoseSample& sample, Real dt_s) {
  bool sound =
      dt_s >= 0.0 && dt_s <= kLongestStepS && state.safety.fault == Fault::kNone;
  for (std::size_t port = 0; port < ports(state); ++port) {
    sound = sound && is_sound(sample.pose[port]);
  }
  return sound;
}

PortPoses tools_of(const VirtualTool& held) {
  PortPoses pose;
  for (std::size_t port = 0; port < pose.size(); ++port) {
    pose[port] = held.tool[port].pose();
  }
  return pose;
}

// Where a device is now, with its velocity since `before`.
DevicePose device_at(const PortPose& pose, const DevicePose& before, Real dt_s) {
  DevicePose now;
  now.position_m = pose.position_m;
  now.turn = Eigen::Quaternion<Real>(pose.rotation).normalized();
  if (dt_s > 0.0) {
    const Real over_s = std::max(dt_s, kVirtualTickMinS);
    now.velocity_m_per_s = (now.position_m - before.position_m) / over_s;
    const Eigen::AngleAxis<Real> turned(now.turn * before.turn.conjugate());
    now.spin_rad_per_s = (turned.angle() / over_s) * turned.axis();
  }
  return now;
}

// Turns that are not felt take the tool with them. @returns whether there were any.
bool turn_along(VirtualBody& tool, DevicePose& before, DevicePose& now) {
  const Eigen::Quaternion<Real> turned = now.turn * before.turn.conjugate();
  now.spin_rad_per_s.setZero();
  if (turned.vec().squaredNorm() <= kNoTurn) {
    return false;
  }
  tool.turn = (turned * tool.turn).normalized();
  tool.momentum_n_m_s = turned * tool.momentum_n_m_s;
  before.turn = now.turn;
  return true;
}

// What the solver left of a tick's identity goes to no hand.
void settle_residual(VirtualTool& held, VirtualBody& tool, double residual_j) {
  VirtualToolAccount& a = held.account;
  a.residual_j = std::max(a.residual_j, std::abs(residual_j));
  if (!(residual_j > 0.0)) {
    a.dissipated_j -= residual_j;
    return;
  }
  const auto kinetic = static_cast<double>(kinetic_j(held.coupling, tool));
  const double taken = std::min(residual_j, kinetic);
  const Real left =
      kinetic > 0.0 ? std::sqrt(static_cast<Real>(1.0 - taken / kinetic)) : Real(1.0);
  tool.velocity_m_per_s *= left;
  tool.momentum_n_m_s *= left;
  a.taken_j += taken;
}

// One port's device and tool in a tick.
void move_port(VirtualTool& held, CoupledState& state, std::size_t port,
               const DevicePose& before, const DevicePose& now, Real dt_s) {
  VirtualBody& tool = held.tool[port];
  OnePort one{held, state, tools_of(held), port};
  const Real h = std::min(dt_s, kVirtualTickMaxS);
  if (h > 0.0) {
    const VirtualTick tick =
        advance(held.coupling, tool, before, now, {&one, &energy_j}, h);
    held.total.work_j += tick.work_j;
    held.account.dissipated_j += tick.dissipated_j;
    held.account.iterations_max =
        std::max(held.account.iterations_max, tick.iterations);
    settle_residual(held, tool, tick.residual_j);
    held.felt[port] = tick.on_device;
  } else {
    held.total.work_j += static_cast<double>(spring_j(held.coupling, tool, now)) -
                         static_cast<double>(spring_j(held.coupling, tool, before));
  }
}

void begin_at(VirtualTool& held, const CoupledState& state, const PoseSample& sample) {
  for (std::size_t port = 0; port < ports(state); ++port) {
    held.device[port] = device_at(sample.pose[port], {}, 0.0);
    held.tool[port] = {};
    held.tool[port].position_m = held.device[port].position_m;
    held.tool[port].turn = held.device[port].turn;
  }
  held.begun = true;
}

void move_ports(VirtualTool& held, CoupledState& state, const PoseSample& sample,
                Real dt_s) {
  std::array<DevicePose, kPortsMax> now;
  bool turned = false;
  for (std::size_t port = 0; port < ports(state); ++port) {
    now[port] = device_at(sample.pose[port], held.device[port], dt_s);
    turned = (!held.torque_felt &&
              turn_along(held.tool[port], held.device[port], now[port])) ||
             turned;
  }
  if (turned) {
    carry(state, tools_of(held));
  }
  for (std::size_t port = 0; port < ports(state); ++port) {
    move_port(held, state, port, held.device[port], now[port], dt_s);
    held.device[port] = now[port];
  }
}

// The account after a tick of the body.
void sum_up(VirtualTool& held, const CoupledState& state) {
  VirtualToolAccount& a = held.account;
  a.kinetic_j = 0.0;
  a.spring_j = 0.0;
  for (std::size_t port = 0; port < ports(state); ++port) {
    a.kinetic_j += static_cast<double>(kinetic_j(held.coupling, held.tool[port]));
    a.spring_j += static_cast<double>(
        spring_j(held.coupling, held.tool[port], held.device[port]));
  }
  const PassivityLedger& body = state.ledger;
  held.total.stored_j = a.kinetic_j + a.spring_j + body.stored_j;
  held.total.tank_j = body.tank_j;
  held.total.dent_j = body.dent_j;
  held.total.left_j = body.left_j;
  held.total.dissipated_j = a.dissipated_j + body.dissipated_j;
  held.total.created_j = body.created_j;
  held.total.interventions = body.interventions;
}

PortPoses devices_of(const VirtualTool& held) {
  PortPoses pose;
  for (std::size_t port = 0; port < pose.size(); ++port) {
    pose[port] = {held.device[port].position_m,
                  held.device[port].turn.toRotationMatrix()};
  }
  return pose;
}

// Of the devices, as far as they feel it.
WrenchSafety::Vector felt_movement(const VirtualTool& held, const CoupledState& state,
                                   const PortPoses& from, const PortPoses& to) {
  WrenchSafety::Vector moved = movement(state.set, from, to);
  for (int port = 0; port < state.set.ports && !held.torque_felt; ++port) {
    moved.segment<3>(6 * port + 3).setZero();
  }
  return moved;
}

}  // namespace

const char* couple(VirtualTool& held, CoupledState& state,
                   const VirtualCoupling& coupling) noexcept {
  if (is_alone(state.set)) {
    return "a virtual coupling is for tools of several contacts, or two hands";
  }
  if (const char* wrong = check(coupling)) {
    return wrong;
  }
  if (!is_heavy_enough(coupling.mass_kg, coupling.spring_n_per_m,
                       coupling.damper_n_s_per_m) ||
      !is_heavy_enough(coupling.inertia_kg_m2.minCoeff(), coupling.spring_n_m_per_rad,
                       coupling.damper_n_m_s)) {
    return "the tool is too light for its springs and dampers: mass and inertia must "
           "be at least h^2 k / 2 + h b with ticks h of 2 ms";
  }
  held.coupling = coupling;
  held.limits = {state.config.force_max_n, state.config.slew_max_n_per_s,
                 state.config.energy_floor_j, state.config.ramp_s};
  state.config.force_max_n = std::numeric_limits<Real>::infinity();
  state.config.slew_max_n_per_s = std::numeric_limits<Real>::infinity();
  state.config.ramp_s = 0.0;
  return nullptr;
}

WrenchCommand step(VirtualTool& held, CoupledState& state, const PoseSample& sample,
                   Real dt_s) noexcept {
  if (!is_sound(state, sample, dt_s)) {
    return step(state, sample, dt_s);  // raises the fault, and gives no force
  }
  const bool first = !held.begun;
  if (first) {
    begin_at(held, state, sample);
  }
  const PortPoses from = devices_of(held);
  relax_ahead(state, dt_s);
  if (!first) {
    move_ports(held, state, sample, dt_s);
  }
  const double work_j = state.ledger.work_j;
  WrenchCommand command = step(state, {tools_of(held), sample.time_ns}, dt_s);
  state.safety.delivered_n = state.safety.model_n;  // the tool got it whole
  held.total.work_j += first ? state.ledger.work_j - work_j : 0.0;
  sum_up(held, state);
  if (state.safety.fault == Fault::kNone) {
    const WrenchSafety::Vector moved =
        felt_movement(held, state, from, devices_of(held));
    command.wrench =
        unflattened(state.set, make_safe(held.safety, held.limits, held.total,
                                         flattened(state.set, held.felt), moved, dt_s));
    raise_fault(state, held.safety.fault);
  }
  if (state.safety.fault != Fault::kNone) {
    command = {};
    held.safety.force_n.setZero();
  }
  state.in_contact = command.in_contact;
  command.stored_j = held.total.stored_j;
  command.tank_j = held.total.tank_j;
  command.dissipated_j = held.total.dissipated_j;
  command.fault = static_cast<std::uint8_t>(state.safety.fault);
  return command;
}

void delivered(VirtualTool& held, const CoupledState& state,
               const PortWrenches& wrench) noexcept {
  const WrenchSafety::Vector v = flattened(state.set, wrench);
  if (v.allFinite() && held.safety.fault == Fault::kNone) {
    held.safety.delivered_n = v;
  }
}

}  // namespace palpate
