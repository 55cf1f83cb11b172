// Options of the subcommands that may drive a haptic device.
#pragma once

#include <string>
#include <vector>

#include "formats/base/command_line.h"
#include "runtime/attach/device_choice.h"
#include "runtime/run/render_run.h"
#include "runtime/run/surface_file.h"

namespace palpate {

/// What the command line says of a device, and of a second hand's.
struct DeviceFlags {
  DeviceRequest request;
  std::string calibration = "1";
  std::vector<double> at_m;
  bool no_sign_test = false;
  std::string probed;  ///< file of a probe; empty: none
  /// Name, usb, device_id and grip_id; the rest is the first one's.
  DeviceRequest second;
  std::string second_calibration = "1";
  std::vector<std::string> tools;  ///< one, or two together; none: the only one
  bool together = false;           ///< two tools press the body, each on its device
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

/// --tool and --together. @param flags must outlive the command.
void add_tool_options(Command command, DeviceFlags& flags);

/// @throws InputError where tools and flags do not say what touches the body.
void check_tools(const DeviceFlags& flags);

/// Of a scene that is computed meanwhile: it is rendered with one tool.
/// @throws InputError for two.
void refuse_together_of_scene(const DeviceFlags& flags);

/// Chooses the device or both, and their tools, for a run in real time. @throws as
/// choose_device(); InputError for a second device without --together.
void attach_device(DeviceFlags& flags, SimulationOptions& options);

}  // namespace palpate
