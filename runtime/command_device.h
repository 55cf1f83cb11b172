// `palpate-run device`: renders a database on a haptic device.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_device_command(CLI::App& app);

}  // namespace palpate
