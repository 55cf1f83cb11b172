#include "runtime/contacts/virtual_coupling.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Quaternion = Eigen::Quaternion<Real>;

// Changes of velocity, in m/s with spins times the lever, that are rounding.
constexpr Real kStill = rounding(1e-16, 1e-8);
// Movements below this tell no direction of a discrete gradient [m^2].
constexpr Real kNoWay = rounding(1e-26, 1e-16);

// cay(w) as a unit quaternion: (1, w / 2), normalised.
Quaternion cayley(const Vector3& w) {
  return Quaternion(Real(1.0), Real(0.5) * w.x(), Real(0.5) * w.y(), Real(0.5) * w.z())
      .normalized();
}

Vector3 spin_of(const VirtualCoupling& c, const Quaternion& turn,
                const Vector3& momentum) {
  return (turn.conjugate() * momentum).cwiseQuotient(c.inertia_kg_m2);
}

// U_c and its wrench on the tool.
Real spring(const VirtualCoupling& c, const PortPose& tool, const DevicePose& device,
            Wrench* wrench) {
  const Vector3 stretch = tool.position_m - device.position_m;
  const Matrix3 held = device.turn.toRotationMatrix();
  // 3 - tr A = |A - 1|^2 / 2 of a rotation, without cancellation.
  const Real twist2 = Real(0.5) * (tool.rotation - held).squaredNorm();
  if (wrench != nullptr) {
    wrench->force_n = -c.spring_n_per_m * stretch;
    wrench->torque_n_m.setZero();
    for (int i = 0; i < 3; ++i) {
      wrench->torque_n_m +=
          (Real(0.5) * c.spring_n_m_per_rad) * tool.rotation.col(i).cross(held.col(i));
    }
  }
  return Real(0.5) *
         (c.spring_n_per_m * stretch.squaredNorm() + c.spring_n_m_per_rad * twist2);
}

struct Wrenches {
  Real energy_j;
  Wrench sum;
};

Wrenches whole(const VirtualCoupling& c, const DevicePose& device,
               const PosePotential& potential, const PortPose& pose, bool wrench) {
  Wrench of_spring;
  Wrench of_body;
  const Real energy =
      spring(c, pose, device, wrench ? &of_spring : nullptr) +
      potential.energy_j(potential.of, pose, wrench ? &of_body : nullptr);
  return {
      energy,
      {of_spring.force_n + of_body.force_n, of_spring.torque_n_m + of_body.torque_n_m}};
}

// What a fixed point goes by.
struct CouplingStep {
  VirtualBody from;
  Vector3 spin0;
  Real energy0_j;
  Real h;
};

struct Guess {
  Vector3 velocity = Vector3::Zero();
  Vector3 spin = Vector3::Zero();
  Quaternion turn = Quaternion::Identity();
  Vector3 momentum = Vector3::Zero();
  Vector3 damper_n = Vector3::Zero();
  Vector3 damper_n_m = Vector3::Zero();
  Vector3 middle_velocity = Vector3::Zero();
  Vector3 middle_spin = Vector3::Zero();  // in the world's frame
};

// The end of the tick that follows from a guess of it.
Guess improved(const VirtualCoupling& c, const DevicePose& device,
               const PosePotential& potential, const CouplingStep& step,
               const Guess& guess) {
  Guess next = guess;
  const Real h = step.h;
  const Matrix3 turn0 = step.from.turn.toRotationMatrix();
  // Simo & Wong 1991 with the letters of the header: middle_in_tool is (W0 + W1) / 2,
  // moved is dp [m], turned is th [rad], way2 is |dp|^2 + L^2 |th|^2.
  const Vector3 middle_in_tool = Real(0.5) * (step.spin0 + guess.spin);
  next.middle_velocity = Real(0.5) * (step.from.velocity_m_per_s + guess.velocity);
  next.middle_spin = turn0 * middle_in_tool;
  const Vector3 moved = h * next.middle_velocity;
  const Vector3 turned = h * next.middle_spin;
  next.turn = (step.from.turn * cayley(h * middle_in_tool)).normalized();
  // The middle pose: p0 + dp / 2 and R0 cay(h W_mid / 2).
  const PortPose middle{
      step.from.position_m + Real(0.5) * moved,
      (step.from.turn * cayley(Real(0.5) * h * middle_in_tool)).toRotationMatrix()};
  const PortPose end{step.from.position_m + moved, next.turn.toRotationMatrix()};
  Wrench given = whole(c, device, potential, middle, true).sum;
  const Real change = whole(c, device, potential, end, false).energy_j - step.energy0_j;
  const Real lever2 = c.lever_m * c.lever_m;
  const Real way2 = moved.squaredNorm() + lever2 * turned.squaredNorm();
  // a = (-(change of U + U_c) - F . dp - T . th) / way2: the discrete gradient.
  if (way2 > kNoWay) {
    const Real a =
        (-change - given.force_n.dot(moved) - given.torque_n_m.dot(turned)) / way2;
    given.force_n += a * moved;
    given.torque_n_m += (a * lever2) * turned;
  }
  // Dampers act on the middle velocities relative to the device.
  next.damper_n =
      -c.damper_n_s_per_m * (next.middle_velocity - device.velocity_m_per_s);
  next.damper_n_m = -c.damper_n_m_s * (next.middle_spin - device.spin_rad_per_s);
  // m (v1 - v0) = h F and R1 J W1 - R0 J W0 = h T, with the dampers' parts.
  next.velocity =
      step.from.velocity_m_per_s + (h / c.mass_kg) * (given.force_n + next.damper_n);
  next.momentum = step.from.momentum_n_m_s + h * (given.torque_n_m + next.damper_n_m);
  next.spin = spin_of(c, next.turn, next.momentum);
  return next;
}

}  // namespace

const char* check(const VirtualCoupling& c) noexcept {
  if (!(c.mass_kg > 0.0) || !(c.inertia_kg_m2.minCoeff() > 0.0) ||
      !std::isfinite(c.mass_kg) || !c.inertia_kg_m2.allFinite()) {
    return "mass and inertia of a virtual tool must be above zero and finite";
  }
  if (!(c.spring_n_per_m >= 0.0 && c.spring_n_m_per_rad >= 0.0 &&
        c.damper_n_s_per_m >= 0.0 && c.damper_n_m_s >= 0.0)) {
    return "springs and dampers of a virtual coupling must not be negative";
  }
  if (!(c.lever_m > 0.0) || !std::isfinite(c.lever_m)) {
    return "the lever of a virtual coupling must be above zero and finite";
  }
  return nullptr;
}

Real kinetic_j(const VirtualCoupling& coupling, const VirtualBody& body) noexcept {
  const Vector3 in_tool = body.turn.conjugate() * body.momentum_n_m_s;
  return Real(0.5) * (coupling.mass_kg * body.velocity_m_per_s.squaredNorm() +
                      in_tool.cwiseAbs2().cwiseQuotient(coupling.inertia_kg_m2).sum());
}

Real spring_j(const VirtualCoupling& coupling, const VirtualBody& body,
              const DevicePose& device) noexcept {
  return spring(coupling, body.pose(), device, nullptr);
}

VirtualTick advance(const VirtualCoupling& coupling, VirtualBody& body,
                    const DevicePose& before, const DevicePose& device,
                    const PosePotential& potential, Real h_s) noexcept {
  VirtualTick tick;
  const PortPose start = body.pose();
  tick.work_j = static_cast<double>(spring_j(coupling, body, device)) -
                static_cast<double>(spring_j(coupling, body, before));
  CouplingStep step{body, spin_of(coupling, body.turn, body.momentum_n_m_s), 0.0, h_s};
  step.energy0_j = whole(coupling, device, potential, start, false).energy_j;
  const Real kinetic0 = kinetic_j(coupling, body);
  Guess guess;
  guess.velocity = body.velocity_m_per_s;
  guess.spin = step.spin0;
  Real last = -1.0;
  while (tick.iterations < kVirtualIterationsMax) {
    ++tick.iterations;
    const Guess next = improved(coupling, device, potential, step, guess);
    const Real change = (next.velocity - guess.velocity).norm() +
                        coupling.lever_m * (next.spin - guess.spin).norm();
    guess = next;
    // To rounding, or no nearer any more.
    if (change <= kStill || (last >= 0.0 && tick.iterations > 4 && !(change < last))) {
      break;
    }
    last = change;
  }
  body.position_m += h_s * guess.middle_velocity;
  body.turn = guess.turn;
  body.velocity_m_per_s = guess.velocity;
  body.momentum_n_m_s = guess.momentum;
  const PortPose end = body.pose();
  const Real energy1 = whole(coupling, device, potential, end, false).energy_j;
  tick.potential_j = static_cast<double>(energy1) -
                     static_cast<double>(spring_j(coupling, body, device));
  const Vector3 relative = guess.middle_velocity - device.velocity_m_per_s;
  const Vector3 turning = guess.middle_spin - device.spin_rad_per_s;
  tick.dissipated_j =
      static_cast<double>(h_s * (coupling.damper_n_s_per_m * relative.squaredNorm() +
                                 coupling.damper_n_m_s * turning.squaredNorm()));
  // The user holds the dampers' other ends.
  const double on_dampers =
      static_cast<double>(h_s * (guess.damper_n.dot(device.velocity_m_per_s) +
                                 guess.damper_n_m.dot(device.spin_rad_per_s)));
  tick.work_j += on_dampers;
  tick.residual_j = static_cast<double>(kinetic_j(coupling, body) - kinetic0) +
                    static_cast<double>(energy1 - step.energy0_j) + tick.dissipated_j -
                    on_dampers;
  Wrench of_spring;
  (void)spring(coupling, end, device, &of_spring);
  tick.on_device = {-(of_spring.force_n + guess.damper_n),
                    -(of_spring.torque_n_m + guess.damper_n_m)};
  return tick;
}

}  // namespace palpate
