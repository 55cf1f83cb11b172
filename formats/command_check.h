#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "check" to the tool.
void add_check_command(CLI::App& app);

}  // namespace palpate
