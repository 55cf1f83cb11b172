// Wrenches and movements of all ports as vectors of forces and lengths: what the limits
// of safety.h are taken of.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "runtime/account/real.h"
#include "runtime/account/safety.h"
#include "runtime/contacts/coupled_model.h"
#include "runtime/contacts/coupled_set.h"

namespace palpate {

/// Force [N] and torque over the lever [N] of each port.
[[nodiscard]] inline WrenchSafety::Vector flattened(const CoupledSet& set,
                                                    const PortWrenches& wrench) {
  WrenchSafety::Vector v = WrenchSafety::Vector::Zero();
  for (int port = 0; port < set.ports; ++port) {
    const Wrench& w = wrench[static_cast<std::size_t>(port)];
    v.segment<3>(6 * port) = w.force_n;
    v.segment<3>(6 * port + 3) =
        w.torque_n_m / set.lever_m[static_cast<std::size_t>(port)];
  }
  return v;
}

[[nodiscard]] inline PortWrenches unflattened(const CoupledSet& set,
                                              const WrenchSafety::Vector& v) {
  PortWrenches wrench;
  for (int port = 0; port < set.ports; ++port) {
    Wrench& w = wrench[static_cast<std::size_t>(port)];
    w.force_n = v.segment<3>(6 * port);
    w.torque_n_m =
        v.segment<3>(6 * port + 3) * set.lever_m[static_cast<std::size_t>(port)];
  }
  return wrench;
}

/// Of each port from a to b [m], turns as rotation vectors times the lever.
[[nodiscard]] inline WrenchSafety::Vector movement(const CoupledSet& set,
                                                   const PortPoses& from,
                                                   const PortPoses& to) {
  WrenchSafety::Vector v = WrenchSafety::Vector::Zero();
  for (int port = 0; port < set.ports; ++port) {
    const PortPose& a = from[static_cast<std::size_t>(port)];
    const PortPose& b = to[static_cast<std::size_t>(port)];
    const Eigen::AngleAxis<Real> turn(Matrix3(b.rotation * a.rotation.transpose()));
    v.segment<3>(6 * port) = b.position_m - a.position_m;
    v.segment<3>(6 * port + 3) =
        (set.lever_m[static_cast<std::size_t>(port)] * turn.angle()) * turn.axis();
  }
  return v;
}

}  // namespace palpate
