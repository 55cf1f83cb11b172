#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "material" to the tool.
void add_material_command(CLI::App& app);

}  // namespace palpate
