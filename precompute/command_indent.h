#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "indent" to the tool.
void add_indent_command(CLI::App& app);

}  // namespace palpate
