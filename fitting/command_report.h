#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "report" to the tool.
void add_fit_report_command(CLI::App& app);

}  // namespace palpate
