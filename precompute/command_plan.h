// palpate-precompute plan: what a build will do, leave out and take.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_plan_command(CLI::App& app);

}  // namespace palpate
