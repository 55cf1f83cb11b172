#include "runtime/command/device_options.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/attach/calibration.h"
#include "runtime/attach/driven_devices.h"
#include "runtime/attach/probe_file.h"
#include "runtime/realtime/stop_signals.h"

namespace palpate {

void tell_person(const std::string& text) {
  fmt::print(stderr, "{}\n", text);
}

void ask_person(const std::string& text) {
  fmt::print(stderr, "{}; then press Enter\n", text);
  for (;;) {
    if (heed_stop_signals()) {
      throw Interrupted();
    }
    constexpr int kLookMs = 100;
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (::poll(&input, 1, kLookMs) <= 0) {
      continue;
    }
    char byte = 0;
    if (::read(STDIN_FILENO, &byte, 1) != 1) {
      throw InputError("standard input ended before it was confirmed");
    }
    if (byte == '\n') {
      return;
    }
  }
}

namespace {

// The bound on stiffness by what was found instead of what is assumed.
void take_probed(const DeviceFlags& flags, SimulationOptions& options) {
  if (flags.probed.empty()) {
    return;
  }
  if (!options.attached) {
    throw InputError(fmt::format(
        "--probed {}: a driver behind a socket says its numbers itself", flags.probed));
  }
  const ProbeReport report = read_probe(flags.probed);
  if (report.device != device_kind(flags.request.name)) {
    throw InputError(fmt::format("--probed {}: is a probe of {}, not of {}",
                                 flags.probed, report.device, flags.request.name));
  }
  DeviceLimits& limits = options.attached->limits;
  limits = probed_limits(report, limits);
  tell_person(
      fmt::format("{}: by its probe: damping {:.3g} N s/m, friction {:.3g} N, step "
                  "{:.3g} mm, delay "
                  "{:.3g} ms",
                  report.device, limits.damping_n_s_per_m, limits.coulomb_n,
                  1e3 * limits.resolution_m, 1e3 * limits.delay_s));
  if (const std::string axes = axes_not_found(report); !axes.empty()) {
    tell_person(
        fmt::format("{}: its probe has not found {}: as assumed, where that is "
                    "worse",
                    report.device, axes));
  }
}

}  // namespace

void add_device_options(Command command, DeviceFlags& flags) {
  DeviceRequest& request = flags.request;
  command.add_option("--device", request.name,
                     "One of: " + known_device_names() +
                         "; haply-inverse:PORT; or a driver's socket, a path with a /");
  command.add_option(
      "--device-id", request.device_id,
      "Which device of a service or a vendor's library, where it has several");
  command.add_option("--grip-id", request.grip_id,
                     "Which grip of the Inverse service turns the tool, where it has "
                     "several");
  command
      .add_option("--events-port", request.events_port,
                  "Where the Inverse service tells events")
      .show_default();
  command
      .add_option("--profile", request.profile, "Name of the Inverse service's session")
      .show_default();
  command.add_option("--firmware", request.firmware,
                     "The vendor's firmware image, for a falcon that has none yet");
  command.add_option("--usb", request.usb,
                     "BUS:ADDRESS, port or serial number, where two are alike");
  command
      .add_option("--calibration", flags.calibration,
                  "Factor on motor commands [-], or a file of palpate-run calibrate")
      .show_default();
  command.add_option("--homing-s", request.homing_s, "Time to home the device [s]")
      .show_default();
  command.add_flag("--event-character", request.event_character,
                   "A falcon's chip sends a reply at its last byte (not tried on "
                   "hardware): more than 1 kHz");
  command.add_flag("--no-sign-test", flags.no_sign_test,
                   "Do not feel at the start whether the motors push the right way");
  command.add_option("--probed", flags.probed,
                     "A probe's file: its damping, friction, step and delay bound "
                     "stiffness instead of assumed ones");
  command.add_option("--plane", request.plane,
                     "Section of the body for a device that moves in a plane: x=0.01 "
                     "[m]; else the one through the pressed node");
  command.add_option("--at", flags.at_m, "Where to press: x,y,z [m]")
      .separated_by(',')
      .one_value_each();
}

void add_surface_options(Command command, SurfaceFiles& files) {
  command.add_option("--surface-in", files.in,
                     "Begin with the dents and the softening of this file");
  command.add_option("--surface-out", files.out,
                     "Write the dents and the softening there when the run is over");
}

void prepare_request(DeviceFlags& flags) {
  flags.request.tell = tell_person;
  flags.request.ask = ask_person;
  flags.request.stopped = [] {
    return heed_stop_signals().load();
  };
  flags.request.sign_test = !flags.no_sign_test;
  flags.request.calibration = motor_factor(flags.calibration, flags.request.name);
}

void attach_device(DeviceFlags& flags, SimulationOptions& options) {
  prepare_request(flags);
  options.real_time = true;
  if (flags.request.name.find('/') != std::string::npos) {
    options.socket = flags.request.name;
  } else {
    options.attached = choose_device(flags.request);
  }
  take_probed(flags, options);
  if (!flags.at_m.empty()) {
    if (flags.at_m.size() != 3) {
      throw InputError(fmt::format("--at has {} coordinates, must have 3: x,y,z [m]",
                                   flags.at_m.size()));
    }
    options.at_m = Eigen::Vector3d(flags.at_m.data());
  }
}

}  // namespace palpate
