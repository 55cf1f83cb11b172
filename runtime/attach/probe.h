// What a device is like, found with at most 0.3 N. A person holds the tool and lets it
// go, in two minutes. Found are its wire, where it reaches, the step of its positions,
// dry friction, mass, and damping. The time from a command to its force is found, too.
//
// Held and moved by hand there is no force. Then nobody holds it, and it stands where
// it is left. A force that rises by r a second moves it at friction f, later by the
// delay. A force that is switched on moves it as PushFit says (probe_fit.h).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "runtime/attach/probe_fit.h"
#include "runtime/device/device_link.h"
#include "runtime/realtime/clock.h"

namespace palpate {

constexpr double kProbeForceMaxN = 0.3;

struct ProbeOptions {
  double force_n = kProbeForceMaxN;  ///< [N] (0, kProbeForceMaxN] largest
  double rise_n_per_s = 0.1;         ///< [N/s] > 0
  double rate_hz = 1000.0;           ///< [Hz] > 0 of exchanges
  double wire_s = 2.0;               ///< [s] > 0 of looking at the wire
  double push_s = 0.12;              ///< [s] > 0 of a push ...
  double push_m = 0.012;             ///< [m] > 0 ... or as far
  int rounds = 2;                    ///< >= 1 of rising forces, there and back
  int pushes = 10;                   ///< >= 2
  std::vector<int> axes{0};          ///< of [0, 2], pushed one after the other
  bool planar = false;               ///< the device moves in its x-y plane
  bool by_hand = false;              ///< somebody holds and moves it first
  double hold_s = 8.0;               ///< [s] > 0 by hand: held still, instead of wire_s
  double move_s = 6.0;               ///< [s] > 0 by hand: in each direction
  double runaway_m = 0.04;           ///< [m] > 0 from where it was let go: stop
  double runaway_m_per_s = 0.6;      ///< [m/s] > 0 over 10 ms, once let go: stop
};

/// Who leads a person. Any may be empty.
struct ProbeGuide {
  std::function<void(const std::string&)> say{};  ///< what is to do now
  std::function<void(double left_s)> progress{};  ///< once a second
  std::function<void(const std::string&)>
      await{};                      ///< says it, returns when it is done
  std::function<bool()> stopped{};  ///< let go and end
};

/// Of one axis of the device.
struct ProbedAxis {
  int axis = 0;
  std::string failure{};           ///< why nothing was found; empty: it was
  double friction_n = 0.0;         ///< [N] at which it begins to move
  double friction_sd_n = 0.0;      ///< [N] of one ramp
  double mass_kg = 0.0;            ///< [kg] felt at the tool
  double damping_n_s_per_m = 0.0;  ///< [N s/m] viscous
  double damping_sd_n_s_per_m = 0.0;
  double delay_s = 0.0;  ///< [s] from the begin of an exchange to its force
  /// [s] > 0 within which a delay is not known. The resolution is twice the estimate's
  /// standard deviation, and the exchange, in which a position is measured at any time.
  double delay_resolution_s = 0.0;
  std::vector<std::vector<ProbeSample>> push{};  ///< as measured

  /// A delay that can be distinguished from none.
  [[nodiscard]] bool has_delay() const noexcept { return delay_s > delay_resolution_s; }
};

struct ProbeReport {
  std::string device;
  std::string palpate;  ///< version
  std::int64_t exchanges = 0;
  std::int64_t missed = 0;
  double exchange_p50_s = 0.0;  ///< [s] duration of one
  double exchange_p99_s = 0.0;
  double exchange_max_s = 0.0;
  double free_rate_hz = 0.0;  ///< [Hz] of exchanges one after the other
  double resolution_m = 0.0;  ///< [m] least step between positions that differ
  double push_n = 0.0;        ///< [N] of pushes
  double force_max_n = 0.0;   ///< [N] largest that was asked for
  bool by_hand = false;
  Eigen::Vector3d lowest_m = Eigen::Vector3d::Zero();   ///< [m] where it was moved by
  Eigen::Vector3d highest_m = Eigen::Vector3d::Zero();  ///< hand, in the device's frame
  std::vector<ProbedAxis> axis;
};

/// On an open link, which it leaves at zero force, whatever happens.
/// @throws DeviceError if the link is lost, the tool does not come to rest, runs away,
/// or moves along no axis; Interrupted when stopped.
[[nodiscard]] ProbeReport probe(DeviceLink& link, const ProbeOptions& options,
                                const ProbeGuide& guide, Clock& clock);

/// [s] that it takes about, without what is waited for.
[[nodiscard]] double probe_duration_s(const ProbeOptions& options);

}  // namespace palpate
