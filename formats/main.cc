// palpate-db: one subcommand per file command_*.cc.
#include "formats/command_check.h"
#include "formats/command_info.h"
#include "formats/command_picture.h"
#include "formats/tool_main.h"

int main(int argc, char** argv) {
  return palpate::run_tool("palpate-db", "Looks into response databases.",
                           {&palpate::add_info_command, &palpate::add_check_command,
                            &palpate::add_picture_command},
                           argc, argv);
}
