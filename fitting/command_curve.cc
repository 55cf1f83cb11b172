#include "fitting/command_curve.h"

#include "formats/error.h"

namespace palpate {

void add_curve_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("curve", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
