// The fast step: one tick of passive rendering, from a tool position to a force.
//
// Bounded work; no allocation, lock, exception, system call or log. It could run on an
// embedded processor: the state is a plain struct, elements come in by accept().
//
//   read device -> accept(state, element) for every message that arrived
//               -> command = step(state, sample, dt) -> write command.force_n
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "runtime/fast/element.h"

namespace palpate {

/// How the force between two slow updates is made (DESIGN names, as the flag --model).
enum class LocalModel : std::uint8_t {
  kSingle,          ///< zero-order hold of the slow process's force
  kFirstOrderHold,  ///< extrapolates in time from the two latest slow forces
  kEqualEnergy,     ///< linear impedance, relaxed state by (20)-(24)
  kEnergyTank,      ///< tangent impedance, what updates free pays for what they cost
  kElement,  ///< curves at the fast rate in the active element (5.2), with ledger
};

/// What the device measured at one tick.
struct FastSample {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< [m] tool reference point
  std::int64_t time_ns = 0;                              ///< [ns] monotonic clock
};

/// What the device is to do, and the account of this tick.
struct FastCommand {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< [N] on the tool; 0 on a fault
  bool in_contact = false;
  bool starved = false;  ///< x_c left the element and its neighbour had not arrived
  bool extrapolated = false;  ///< deeper than a curve was computed
  double depth_m = 0.0;       ///< [m] along the response direction
  double stored_j = 0.0;      ///< [J] potential of the local model
  double tank_j = 0.0;        ///< [J] >= 0
  double dissipated_j = 0.0;  ///< [J] >= 0, friction and discarded surplus, since start
  double relaxed_shift_m = 0.0;  ///< [m] >= 0, delta_0 that the ledger had to take
  std::uint8_t fault = 0;        ///< Fault, latched; 0 none
};

}  // namespace palpate
