// palpate-db diff: how far two databases of one body are apart in force.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_diff_command(CLI::App& app);

}  // namespace palpate
