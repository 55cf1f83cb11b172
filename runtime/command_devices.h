#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "devices" to the tool.
void add_devices_command(CLI::App& app);

}  // namespace palpate
