// The subcommands of palpate-run, each in its own command_*.cc.
#pragma once

#include "formats/base/command_line.h"

namespace palpate {

void add_bench_command(Command app);
void add_calibrate_command(Command app);
void add_device_command(Command app);
void add_driver_command(Command app);
void add_devices_command(Command app);
void add_probe_command(Command app);
void add_replay_command(Command app);
void add_simulate_command(Command app);
void add_view_command(Command app);

}  // namespace palpate
