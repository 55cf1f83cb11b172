// palpate-run: one subcommand per file command_*.cc.
#include "formats/tool_main.h"
#include "runtime/command_bench.h"
#include "runtime/command_calibrate.h"
#include "runtime/command_device.h"
#include "runtime/command_devices.h"
#include "runtime/command_replay.h"
#include "runtime/command_simulate.h"
#include "runtime/command_view.h"

int main(int argc, char** argv) {
  return palpate::run_tool("palpate-run", "Renders response databases, passively.",
                           {&palpate::add_simulate_command, &palpate::add_bench_command,
                            &palpate::add_device_command, &palpate::add_devices_command,
                            &palpate::add_calibrate_command, &palpate::add_view_command,
                            &palpate::add_replay_command},
                           argc, argv);
}
