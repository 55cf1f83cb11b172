// palpate-precompute submit: a build shared out among machines.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_submit_command(CLI::App& app);

}  // namespace palpate
