#include "precompute/command_check.h"

#include "formats/error.h"

namespace palpate {

void add_check_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("check", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
