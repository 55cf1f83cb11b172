// palpate-db merge: the tools of several databases of one body in one file, or the
// shards of one build in a database.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_merge_command(CLI::App& app);

}  // namespace palpate
