// The subcommands of palpate-fit, each in its own command_*.cc.
#pragma once

#include "formats/base/command_line.h"

namespace palpate {

void add_batch_command(Command app);
void add_curve_command(Command app);
void add_insertion_command(Command app);
void add_lateral_command(Command app);
void add_material_command(Command app);
void add_fit_report_command(Command app);
void add_surface_command(Command app);

}  // namespace palpate
