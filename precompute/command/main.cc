// palpate-precompute: one subcommand per file command_*.cc.
#include "formats/base/command_line.h"
#include "formats/hdf5/hdf5_lock.h"
#include "precompute/command/commands.h"

int main(int argc, char** argv) {
  palpate::skip_hdf5_exit_cleanup();
  return palpate::run_tool("palpate-precompute",
                           "Computes force-deflection responses of deformable bodies.",
                           {&palpate::add_body_command, &palpate::add_build_command,
                            &palpate::add_check_command, &palpate::add_indent_command,
                            &palpate::add_pairs_command, &palpate::add_plan_command,
                            &palpate::add_remesh_command, &palpate::add_serve_command,
                            &palpate::add_spheres_command, &palpate::add_submit_command,
                            &palpate::add_sweep_command, &palpate::add_trade_command},
                           argc, argv);
}
