// palpate-db merge: the tools of several databases of one body in one file.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_merge_command(CLI::App& app);

}  // namespace palpate
