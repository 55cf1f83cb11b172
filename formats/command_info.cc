#include "formats/command_info.h"

#include "formats/error.h"

namespace palpate {

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
