// palpate-fit: one subcommand per file command_*.cc.
#include "fitting/command_batch.h"
#include "fitting/command_curve.h"
#include "fitting/command_material.h"
#include "fitting/command_report.h"
#include "fitting/command_surface.h"
#include "formats/tool_main.h"

int main(int argc, char** argv) {
  return palpate::run_tool(
      "palpate-fit", "Fits measured indentations.",
      {&palpate::add_curve_command, &palpate::add_batch_command,
       &palpate::add_fit_report_command, &palpate::add_surface_command,
       &palpate::add_material_command},
      argc, argv);
}
