// `palpate-run calibrate`: what a device's motors really give, by a hung mass.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_calibrate_command(CLI::App& app);

}  // namespace palpate
