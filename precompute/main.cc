// palpate-precompute: one subcommand per file command_*.cc.
#include "formats/tool_main.h"
#include "precompute/command_body.h"
#include "precompute/command_build.h"
#include "precompute/command_check.h"
#include "precompute/command_indent.h"
#include "precompute/command_plan.h"
#include "precompute/command_remesh.h"
#include "precompute/command_submit.h"
#include "precompute/command_sweep.h"
#include "precompute/command_trade.h"

int main(int argc, char** argv) {
  return palpate::run_tool("palpate-precompute",
                           "Computes force-deflection responses of deformable bodies.",
                           {&palpate::add_body_command, &palpate::add_build_command,
                            &palpate::add_check_command, &palpate::add_indent_command,
                            &palpate::add_plan_command, &palpate::add_remesh_command,
                            &palpate::add_submit_command, &palpate::add_sweep_command,
                            &palpate::add_trade_command},
                           argc, argv);
}
