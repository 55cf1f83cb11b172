#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds the subcommand "bench" to the tool.
void add_bench_command(CLI::App& app);

}  // namespace palpate
