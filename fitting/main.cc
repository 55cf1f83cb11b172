// palpate-fit: one subcommand per file command_*.cc.
#include "fitting/command_curve.h"
#include "formats/tool_main.h"

int main(int argc, char** argv) {
  CLI::App app("Fits measured indentations.", "palpate-fit");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.require_subcommand(1);
  palpate::add_curve_command(app);
  return palpate::run_tool(app, argc, argv);
}
