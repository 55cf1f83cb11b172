// palpate-db: one subcommand per file command_*.cc.
#include "formats/command_bench.h"
#include "formats/command_check.h"
#include "formats/command_diff.h"
#include "formats/command_export.h"
#include "formats/command_info.h"
#include "formats/command_merge.h"
#include "formats/command_picture.h"
#include "formats/command_report.h"
#include "formats/command_slice.h"
#include "formats/tool_main.h"

int main(int argc, char** argv) {
  return palpate::run_tool("palpate-db",
                           "Looks into response databases, and takes them apart.",
                           {&palpate::add_info_command, &palpate::add_check_command,
                            &palpate::add_picture_command, &palpate::add_diff_command,
                            &palpate::add_slice_command, &palpate::add_merge_command,
                            &palpate::add_export_command, &palpate::add_bench_command,
                            &palpate::add_report_command},
                           argc, argv);
}
