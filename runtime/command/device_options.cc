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
    if (stop_signals()) {
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
                     "A probe's file, of the first device: its damping, friction, step "
                     "and delay bound "
                     "stiffness instead of assumed ones");
  command.add_option("--plane", request.plane,
                     "Section of the body for a device that moves in a plane: x=0.01 "
                     "[m]; else the one through the pressed node");
  command.add_option("--second-device", flags.second.name,
                     "With --together: the second tool's device; what else is said of "
                     "the first holds for it, --plane and --firmware if it is of the "
                     "same kind");
  command.add_option("--second-device-id", flags.second.device_id,
                     "As --device-id, of the second device");
  command.add_option("--second-grip-id", flags.second.grip_id,
                     "As --grip-id, of the second device");
  command.add_option("--second-usb", flags.second.usb,
                     "As --usb, of the second device");
  command
      .add_option("--second-calibration", flags.second_calibration,
                  "As --calibration, of the second device")
      .show_default();
  command
      .add_option("--at", flags.at_m,
                  "Where to press: x,y,z [m], of two tools together six")
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
    return stop_signals().load();
  };
  flags.request.sign_test = !flags.no_sign_test;
  flags.request.calibration = motor_factor(flags.calibration, flags.request.name);
}

namespace {

// A driver's socket, or a device that is chosen here.
void seat(const DeviceRequest& request, std::filesystem::path& socket,
          std::optional<AttachedDevice>& attached) {
  if (request.name.find('/') != std::string::npos) {
    socket = request.name;
  } else {
    attached = choose_device(request);
  }
}

// Where the tool of that number presses; none: anywhere.
std::optional<Eigen::Vector3d> pressed_at(const DeviceFlags& flags, std::size_t tool) {
  if (flags.at_m.empty()) {
    return std::nullopt;
  }
  const std::size_t wanted = flags.together ? 6 : 3;
  if (flags.at_m.size() != wanted) {
    throw InputError(fmt::format("--at has {} coordinates, must have {}: {} [m]",
                                 flags.at_m.size(), wanted,
                                 flags.together ? "x,y,z of each tool" : "x,y,z"));
  }
  return Eigen::Vector3d(&flags.at_m[3 * tool]);
}

SecondHand second_hand(const DeviceFlags& flags) {
  if (flags.second.name.empty()) {
    throw InputError(
        "--together: the second tool's device is missing, give --second-device");
  }
  DeviceRequest request = flags.request;
  request.name = flags.second.name;
  request.usb = flags.second.usb;
  request.device_id = flags.second.device_id;
  request.grip_id = flags.second.grip_id;
  request.profile += "-second";
  if (device_kind(request.name) != device_kind(flags.request.name)) {
    request.plane.clear();
    request.firmware.clear();
  }
  SecondHand second{.tool = flags.tools[1], .at_m = pressed_at(flags, 1)};
  try {
    request.calibration = motor_factor(flags.second_calibration, request.name);
    seat(request, second.socket, second.attached);
  } catch (const InputError& wrong) {
    throw InputError(fmt::format("second device: {}", wrong.what()));
  }
  return second;
}

}  // namespace

void add_tool_options(Command command, DeviceFlags& flags) {
  command
      .add_option("--tool", flags.tools,
                  "Tool, or two with --together: a,b; may be left out if there is one")
      .separated_by(',')
      .one_value_each();
  command.add_flag("--together", flags.together,
                   "Two tools press one body together, coupled through it (a pinch)");
}

void check_tools(const DeviceFlags& flags) {
  if (flags.together && flags.tools.size() != 2) {
    throw InputError(fmt::format(
        "--together: two tools press the body, must be two as --tool a,b, {} given",
        flags.tools.size()));
  }
  if (!flags.together && flags.tools.size() > 1) {
    throw InputError(
        fmt::format("--tool names {} tools: must be one, or two that press the body "
                    "together (--together)",
                    flags.tools.size()));
  }
}

void refuse_together_of_scene(const DeviceFlags& flags) {
  if (flags.together || flags.tools.size() > 1) {
    throw InputError(
        "a scene is rendered with one tool while it is computed: leave out --together, "
        "or build its database first");
  }
}

void attach_device(DeviceFlags& flags, SimulationOptions& options) {
  prepare_request(flags);
  options.real_time = true;
  options.tool = flags.tools.empty() ? "" : flags.tools.front();
  options.at_m = pressed_at(flags, 0);
  seat(flags.request, options.socket, options.attached);
  take_probed(flags, options);
  if (flags.together) {
    options.together = second_hand(flags);
  } else if (!flags.second.name.empty()) {
    throw InputError("--second-device: holds the second of two tools, give --together");
  }
}

}  // namespace palpate
