#include "precompute/command_build.h"

#include "formats/error.h"

namespace palpate {

void add_build_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("build", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
