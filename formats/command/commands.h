// The subcommands of palpate-db, each in its own command_*.cc.
#pragma once

#include "formats/base/command_line.h"

namespace palpate {

void add_bench_command(Command app);
void add_check_command(Command app);
void add_diff_command(Command app);
void add_export_command(Command app);
void add_info_command(Command app);
void add_merge_command(Command app);
void add_picture_command(Command app);
void add_report_command(Command app);
void add_slice_command(Command app);

}  // namespace palpate
