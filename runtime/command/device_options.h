// Options of the subcommands that may drive a haptic device.
#pragma once

#include <string>
#include <vector>

#include "formats/base/command_line.h"
#include "runtime/attach/device_choice.h"
#include "runtime/run/render_run.h"
#include "runtime/run/surface_file.h"

namespace palpate {

/// What the command line says of a device.
struct DeviceFlags {
  DeviceRequest request;
  std::string calibration = "1";
  std::vector<double> at_m;
  bool no_sign_test = false;
  std::string probed;  ///< file of a probe; empty: none
};

/// --device and what goes with it. @param flags must outlive the command.
void add_device_options(Command command, DeviceFlags& flags);

/// --surface-in and --surface-out. @param files must outlive the command.
void add_surface_options(Command command, SurfaceFiles& files);

/// A line on stderr, for the person at the terminal.
void tell_person(const std::string& text);

/// Says what a person is to do and waits for Enter. @throws Interrupted on a signal,
/// InputError where standard input ends.
void ask_person(const std::string& text);

/// Completes the request by what a terminal can do: telling, asking, stopping.
/// @throws as motor_factor().
void prepare_request(DeviceFlags& flags);

/// Chooses the device, for a run in real time. @throws as choose_device().
void attach_device(DeviceFlags& flags, SimulationOptions& options);

}  // namespace palpate
