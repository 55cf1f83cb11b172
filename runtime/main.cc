// palpate-run: one subcommand per file command_*.cc.
#include "formats/tool_main.h"
#include "runtime/command_bench.h"
#include "runtime/command_devices.h"
#include "runtime/command_simulate.h"

int main(int argc, char** argv) {
  CLI::App app("Renders response databases, passively.", "palpate-run");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.require_subcommand(1);
  palpate::add_simulate_command(app);
  palpate::add_bench_command(app);
  palpate::add_devices_command(app);
  return palpate::run_tool(app, argc, argv);
}
