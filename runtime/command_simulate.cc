#include "runtime/command_simulate.h"

#include "formats/error.h"

namespace palpate {

void add_simulate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("simulate", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
