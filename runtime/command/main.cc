// palpate-run: one subcommand per file command_*.cc.
#include "formats/base/command_line.h"
#include "formats/hdf5/hdf5_lock.h"
#include "runtime/command/commands.h"

int main(int argc, char** argv) {
  palpate::skip_hdf5_exit_cleanup();
  return palpate::run_tool("palpate-run", "Renders response databases, passively.",
                           {&palpate::add_simulate_command, &palpate::add_bench_command,
                            &palpate::add_device_command, &palpate::add_devices_command,
                            &palpate::add_calibrate_command, &palpate::add_view_command,
                            &palpate::add_replay_command, &palpate::add_probe_command,
                            &palpate::add_driver_command},
                           argc, argv);
}
