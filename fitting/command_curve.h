#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "curve" to the tool.
void add_curve_command(CLI::App& app);

}  // namespace palpate
