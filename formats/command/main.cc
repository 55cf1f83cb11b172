// palpate-db: one subcommand per file command_*.cc.
#include "formats/base/command_line.h"
#include "formats/command/commands.h"
#include "formats/hdf5/hdf5_lock.h"

int main(int argc, char** argv) {
  palpate::skip_hdf5_exit_cleanup();
  return palpate::run_tool("palpate-db",
                           "Looks into response databases, and takes them apart.",
                           {&palpate::add_info_command, &palpate::add_check_command,
                            &palpate::add_picture_command, &palpate::add_diff_command,
                            &palpate::add_slice_command, &palpate::add_merge_command,
                            &palpate::add_export_command, &palpate::add_bench_command,
                            &palpate::add_report_command},
                           argc, argv);
}
