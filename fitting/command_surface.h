#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "surface" to the tool.
void add_surface_command(CLI::App& app);

}  // namespace palpate
