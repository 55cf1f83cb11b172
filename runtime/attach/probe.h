// What a device is like, found with at most 0.3 N: its wire, the step of its positions,
// dry friction, mass, and the time from a command to its force.
//
// Nobody holds the tool, and it stands where it is left. A force that rises by r a
// second moves it at friction f; from then on, for a short way, m x'' = r (t - t_f), so
// that the cube root of the way is linear in time and zero at t_f = f / r. A force F
// that is switched on gives x = a/2 (t - d)^2 + c (t - d)^3 from the delay d on, with
// a = (F - f) / m and a c < 0 of whatever damps: one a, c and d for all pushes, each
// from a place of its own within the step of the positions, so that the step averages
// out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "runtime/device/device_link.h"
#include "runtime/realtime/step_histogram.h"

namespace palpate {

struct ProbeOptions {
  double force_n = 0.3;       ///< [N] (0, 0.3] largest
  double rise_n_per_s = 0.1;  ///< [N/s] > 0
  double rate_hz = 1000.0;    ///< [Hz] > 0 of exchanges
  double wire_s = 2.0;        ///< [s] > 0 of looking at the wire
  double push_s = 0.08;       ///< [s] > 0 of a push
  int rounds = 2;             ///< >= 1 of rising forces, there and back
  int pushes = 10;            ///< >= 2
  int axis = 0;               ///< [0, 2]
  double runaway_m = 0.04;    ///< [m] > 0 from where it began: stop
};

struct ProbeReport {
  std::string device;
  std::int64_t exchanges = 0;
  std::int64_t missed = 0;
  StepHistogram exchange;      ///< duration of one
  double free_rate_hz = 0.0;   ///< [Hz] of exchanges one after the other
  double resolution_m = 0.0;   ///< [m] least step between positions that differ
  double friction_n = 0.0;     ///< [N] at which it begins to move
  double friction_sd_n = 0.0;  ///< [N] of one ramp
  double mass_kg = 0.0;        ///< [kg]
  double delay_s = 0.0;        ///< [s] from the begin of an exchange to its force
};

/// On an open link, which it leaves at zero force. Takes 25 s and less.
/// @param stopped ends it; may be empty. @throws DeviceError if the link is lost, the
/// tool does not move under the largest force, does not come to rest, or runs away;
/// Interrupted when stopped.
[[nodiscard]] ProbeReport probe(DeviceLink& link, const ProbeOptions& options,
                                const std::function<bool()>& stopped);

/// The report for people, and as a file to send.
[[nodiscard]] std::string probe_text(const ProbeReport& report);
[[nodiscard]] std::string probe_json(const ProbeReport& report);

}  // namespace palpate
