// palpate-precompute: one subcommand per file command_*.cc.
#include "formats/tool_main.h"
#include "precompute/command_body.h"
#include "precompute/command_build.h"
#include "precompute/command_check.h"
#include "precompute/command_indent.h"

int main(int argc, char** argv) {
  CLI::App app("Computes force-deflection responses of deformable bodies.",
               "palpate-precompute");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.require_subcommand(1);
  palpate::add_body_command(app);
  palpate::add_build_command(app);
  palpate::add_check_command(app);
  palpate::add_indent_command(app);
  return palpate::run_tool(app, argc, argv);
}
