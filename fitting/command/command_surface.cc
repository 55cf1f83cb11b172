// palpate-fit surface: a session of indentations in, a response at every node out.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fitting/command/commands.h"
#include "fitting/session/session_machine.h"
#include "fitting/session/surface_session.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

struct SurfaceOptions {
  std::string session;
  std::string output;
  std::string cycle;
  bool json = false;
};

void run_surface(const SurfaceOptions& options) {
  Session session = read_session(options.session);
  if (!options.cycle.empty()) {
    session.fit.cycle = parse_cycle(options.cycle);
  }
  std::vector<std::string> notes;
  const SurfaceFit fit = fit_session_surface(session, notes);
  write_database(options.output, fit.database);
  if (options.json) {
    fmt::print("{}\n", json_text(to_json(fit.report, notes)));
  } else {
    fmt::print("{}{}", describe_notes(session), describe(fit.report));
    for (const std::string& note : notes) {
      fmt::print("note: {}\n", note);
    }
    if (session.registration) {
      fmt::print("registration: {}", describe_registration(session));
    }
  }
}

}  // namespace

void add_surface_command(Command app) {
  auto options = std::make_shared<SurfaceOptions>();
  Command command = app.add_subcommand(
      "surface", "From indentations at scattered points to a response at every node.");
  command.add_option("SESSION", options->session, "session file (TOML)").required();
  command.add_option("-o,--output", options->output, "response database").required();
  command.add_option("--cycle", options->cycle,
                     "press taken of each file: first, last or a number; default: the "
                     "session's, else first");
  command.add_flag("--json", options->json, "report for programs");
  command.callback([options] {
    run_surface(*options);
  });
}

}  // namespace palpate
