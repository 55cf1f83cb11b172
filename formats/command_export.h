// palpate-db export: a database as VTU, CSV or JSON.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_export_command(CLI::App& app);

}  // namespace palpate
