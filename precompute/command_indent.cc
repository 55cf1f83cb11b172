#include "precompute/command_indent.h"

#include "formats/error.h"

namespace palpate {

void add_indent_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("indent", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
