#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "batch" to the tool.
void add_batch_command(CLI::App& app);

}  // namespace palpate
