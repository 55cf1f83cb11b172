// palpate-db report: a database as a page for a browser.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_report_command(CLI::App& app);

}  // namespace palpate
