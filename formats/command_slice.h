// palpate-db slice: a part of a database, by region, tool, depth and precision.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_slice_command(CLI::App& app);

}  // namespace palpate
