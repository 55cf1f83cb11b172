// palpate-run replay: renders a recorded run again and compares.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "replay" to the tool.
void add_replay_command(CLI::App& app);

}  // namespace palpate
