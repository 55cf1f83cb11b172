// palpate-precompute sweep
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_sweep_command(CLI::App& app);

}  // namespace palpate
