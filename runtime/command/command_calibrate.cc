// `palpate-run calibrate`: what a device's motors really give, by a hung mass.
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/attach/calibration.h"
#include "runtime/attach/device_choice.h"
#include "runtime/attach/hung_mass.h"
#include "runtime/attach/sign_test.h"
#include "runtime/command/commands.h"
#include "runtime/command/device_options.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/stop_signals.h"
#include "runtime/usb/falcon_geometry.h"

namespace palpate {
namespace {

struct CalibrateFlags {
  DeviceRequest device;
  double mass_kg = 0.0;
  std::string output = "calibration.toml";
  bool json = false;
};

void check(const CalibrateFlags& flags) {
  if (!(flags.mass_kg >= 0.05 && flags.mass_kg <= 0.5)) {
    throw InputError(
        fmt::format("--mass-kg {}: must lie in [0.05, 0.5]", flags.mass_kg));
  }
}

// Opens the device, which homes it, and weighs what hangs on it. A signal ends either;
// the link is closed first.
Weight opened_and_weighed(const std::unique_ptr<DeviceLink> link) {
  link->open();
  const Weight weight = weigh(*link, falcon_centre_m(), {}, stop_signals());
  link->close();
  release_stop_signals();
  return weight;
}

void ask(const CalibrateFlags& flags, const std::string& what) {
  if (!is_emulated(flags.device.name)) {
    ask_person(fmt::format("{}: {}", flags.device.name, what));
  }
}

// While somebody holds the grip: it would fall.
void test_motor_signs(const CalibrateFlags& flags) {
  if (is_emulated(flags.device.name)) {
    return;
  }
  ask(flags, "hold its grip loosely in the middle: it is pushed to and fro a little");
  const std::unique_ptr<DeviceLink> link = calibration_link(flags.device, 0.0);
  link->open();
  MonotonicClock clock;
  static_cast<void>(test_signs(*link, {}, flags.device.stopped, clock));
  link->close();
  release_stop_signals();
}

void calibrate(CalibrateFlags& flags) {
  check(flags);
  flags.device.tell = tell_person;
  flags.device.stopped = [] {
    return stop_signals().load();
  };
  test_motor_signs(flags);
  auto bare_link = calibration_link(flags.device, 0.0);
  ask(flags, "lay it so that its y axis points up; it will carry its own grip");
  const Weight bare = opened_and_weighed(std::move(bare_link));
  ask(flags, fmt::format("hang {} kg on the grip and support it until it is carried",
                         flags.mass_kg));
  const Weight loaded =
      opened_and_weighed(calibration_link(flags.device, flags.mass_kg));
  Calibration calibration{.device = flags.device.name, .mass_kg = flags.mass_kg};
  calibration.motor_factor =
      factor_of(bare, loaded, flags.mass_kg, calibration.motor_factor_sd);
  write_calibration(flags.output, calibration);
  if (flags.json) {
    const nlohmann::json json = {{"device", calibration.device},
                                 {"motor_factor", calibration.motor_factor},
                                 {"motor_factor_sd", calibration.motor_factor_sd},
                                 {"mass_kg", calibration.mass_kg},
                                 {"bare_n", bare.force_n},
                                 {"loaded_n", loaded.force_n},
                                 {"file", flags.output}};
    fmt::print("{}\n", json_text(json, 2));
    return;
  }
  fmt::print("asked for           {:.4g} N bare, {:.4g} N with {:.4g} kg\n",
             bare.force_n, loaded.force_n, flags.mass_kg);
  fmt::print("motor factor        {:.4g} +- {:.2g}, written to {}\n",
             calibration.motor_factor, calibration.motor_factor_sd, flags.output);
}

}  // namespace

void add_calibrate_command(Command app) {
  Command command = app.add_subcommand(
      "calibrate", "Find the factor on a device's motor commands by a suspended mass.");
  const auto flags = std::make_shared<CalibrateFlags>();
  command.add_option("--device", flags->device.name, "falcon or emulated-falcon")
      .required();
  command.add_option("--mass-kg", flags->mass_kg, "Mass to suspend from the grip [kg]")
      .required();
  command.add_option("-o,--output", flags->output, "Calibration file to write (TOML)")
      .show_default();
  command.add_option("--firmware", flags->device.firmware,
                     "The vendor's firmware image, for a falcon that has none yet");
  command.add_option("--usb", flags->device.usb,
                     "BUS:ADDRESS, port or serial number, where two are alike");
  command
      .add_option("--homing-s", flags->device.homing_s, "Time to home the device [s]")
      .show_default();
  command.add_flag("--json", flags->json, "Print the report for programs");
  command.callback([flags] {
    calibrate(*flags);
  });
}

}  // namespace palpate
