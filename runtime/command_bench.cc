#include "runtime/command_bench.h"

#include "formats/error.h"

namespace palpate {

void add_bench_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "");
  command->callback([] {
    throw NumericalError("not built yet");
  });
}

}  // namespace palpate
