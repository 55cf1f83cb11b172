// palpate-db: one subcommand per file command_*.cc.
#include "formats/command_check.h"
#include "formats/command_info.h"
#include "formats/command_picture.h"
#include "formats/tool_main.h"

int main(int argc, char** argv) {
  CLI::App app("Looks into response databases.", "palpate-db");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.require_subcommand(1);
  palpate::add_info_command(app);
  palpate::add_check_command(app);
  palpate::add_picture_command(app);
  return palpate::run_tool(app, argc, argv);
}
