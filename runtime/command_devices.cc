#include "runtime/command_devices.h"

#include "formats/error.h"

namespace palpate {

void add_devices_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
