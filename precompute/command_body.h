#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "body" to the tool.
void add_body_command(CLI::App& app);

}  // namespace palpate
