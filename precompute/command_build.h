#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "build" to the tool.
void add_build_command(CLI::App& app);

}  // namespace palpate
