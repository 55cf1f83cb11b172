// palpate-db bench precision: what each way of storing a database costs.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_bench_command(CLI::App& app);

}  // namespace palpate
