#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "picture" to the tool.
void add_picture_command(CLI::App& app);

}  // namespace palpate
