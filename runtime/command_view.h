// palpate-run view: see and feel a database in a browser, with the mouse.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_view_command(CLI::App& app);

}  // namespace palpate
