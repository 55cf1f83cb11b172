#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "simulate" to the tool.
void add_simulate_command(CLI::App& app);

}  // namespace palpate
