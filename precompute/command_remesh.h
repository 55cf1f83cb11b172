#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "remesh" to the tool.
void add_remesh_command(CLI::App& app);

}  // namespace palpate
