#include "formats/command_picture.h"

#include "formats/error.h"

namespace palpate {

void add_picture_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("picture", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
