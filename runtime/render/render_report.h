// What a run of the renderer did, in numbers.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/recording/kept_surface.h"
#include "runtime/contacts/virtual_tool.h"
#include "runtime/fast/fast_step.h"
#include "runtime/realtime/step_histogram.h"

namespace palpate {

/// What a needle did.
struct NeedleReport {
  bool punctures = false;     ///< the tool is a needle
  std::int32_t channels = 0;  ///< that it has opened
  std::uint64_t broken = 0;   ///< membranes
  std::uint64_t refused = 0;  ///< ticks in which no channel was free
  double deepest_m = 0.0;     ///< [m] of any channel
  double crack_j = 0.0;       ///< [J] spent on new surface
  double released_j = 0.0;    ///< [J] set free by ruptures beyond that
  double shaft_j = 0.0;       ///< [J] dissipated along and across the shaft
};

struct RenderReport {
  std::int64_t ticks = 0;               ///< fast steps
  std::int64_t contact_ticks = 0;       ///< of them with force from the body
  std::int64_t starved_ticks = 0;       ///< without the element they needed
  std::int64_t extrapolated_ticks = 0;  ///< deeper than a curve was computed
  std::int64_t scaled_ticks = 0;        ///< with contacts coupled less than they are
  std::int32_t contacts_max = 0;        ///< that carried something at once
  std::int64_t late_reads = 0;          ///< device had no answer in time
  std::int64_t missed_deadlines = 0;    ///< fast periods without a step
  std::int64_t slow_updates = 0;
  std::int64_t slow_missed_deadlines = 0;
  std::int64_t slow_stalls = 0;        ///< times that no element came for too long
  std::uint64_t elements_dropped = 0;  ///< the queue was full

  double duration_s = 0.0;
  double depth_max_m = 0.0;     ///< [m] along the response direction
  double force_max_n = 0.0;     ///< [N] that left for a device
  double torque_max_n_m = 0.0;  ///< [N m] of several contacts
  /// Work of the tool on what was rendered, with each force as it was held until the
  /// next: what the hand felt. In minus out is the net energy, negative if the renderer
  /// gave more than it got.
  double energy_in_j = 0.0;
  double energy_out_j = 0.0;
  double held_s = 0.0;  ///< [s] that the wire held a force at the end; 0: not looked at
  double model_work_j = 0.0;   ///< [J] put into the local model (ledger); >= 0: passive
  double lowest_work_j = 0.0;  ///< [J] <= 0, least that it ever was
  double stored_j = 0.0;       ///< [J] at the end, in the local model
  double dissipated_j = 0.0;   ///< [J] by friction and discarded surplus
  double tank_j = 0.0;         ///< [J] at the end
  double tank_max_j = 0.0;
  bool relaxes = false;           ///< the body does
  double memory_j = 0.0;          ///< [J] in dents at the end
  double memory_max_j = 0.0;      ///< [J]
  double carried_max_n = 0.0;     ///< [N] most that had relaxed of the normal force ...
  double carried_of_n = 0.0;      ///< [N] ... and what was left of it then
  std::int64_t dents = 0;         ///< memory sites that have not recovered at the end
  std::uint64_t forgotten = 0;    ///< dents that gave way to others
  bool yields = false;            ///< the body leaves dents or softens
  double yielded_j = 0.0;         ///< [J] dissipated by it
  std::uint64_t not_yielded = 0;  ///< times that a site had no room to yield
  NeedleReport needle;            ///< of a tool that punctures
  KeptSurface surface;            ///< what stays of the run for good
  double rest_offset_max_m = 0.0;  ///< [m] most that the ledger had to take
  std::optional<VirtualToolAccount> coupling = {};  ///< of a tool that hangs by one

  StepHistogram step_time;  ///< taking in elements and one step, wall time
  Fault fault = Fault::kNone;
  double fault_s = 0.0;  ///< [s] from the start
  bool interrupted = false;
  std::exception_ptr slow_error;  ///< what ended the slow process early; null: nothing
  std::string slow_failure;       ///< its message; the fast process went on without
  std::string scheduling;         ///< what the system granted; empty in simulated time

  [[nodiscard]] double net_energy_j() const noexcept {
    return energy_in_j - energy_out_j;
  }
};

struct HandPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

/// One tick, as it went to the devices.
struct RenderTick {
  std::int64_t time_ns = 0;
  std::array<HandPose, kPortsMax> pose;
  WrenchCommand command;
  double work_j = 0.0;  ///< [J] by the ledger
};

}  // namespace palpate
