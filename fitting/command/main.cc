// palpate-fit: one subcommand per file command_*.cc.
#include "fitting/command/commands.h"
#include "formats/base/command_line.h"
#include "formats/hdf5/hdf5_lock.h"

int main(int argc, char** argv) {
  palpate::skip_hdf5_exit_cleanup();
  return palpate::run_tool(
      "palpate-fit", "Fits measured indentations.",
      {&palpate::add_curve_command, &palpate::add_insertion_command,
       &palpate::add_lateral_command, &palpate::add_batch_command,
       &palpate::add_fit_report_command, &palpate::add_surface_command,
       &palpate::add_material_command},
      argc, argv);
}
