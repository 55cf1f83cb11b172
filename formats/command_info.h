#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "info" to the tool.
void add_info_command(CLI::App& app);

}  // namespace palpate
