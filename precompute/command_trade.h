// palpate-precompute trade: what accuracy costs on a scene.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

void add_trade_command(CLI::App& app);

}  // namespace palpate
