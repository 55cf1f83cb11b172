#include "runtime/command_view.h"

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/clock.h"
#include "runtime/cylinder_body.h"
#include "runtime/live_view.h"
#include "runtime/page_assets.h"
#include "runtime/simulation.h"
#include "runtime/stop_signals.h"
#include "runtime/view_policy.h"
#include "runtime/view_server.h"
#include "runtime/view_session.h"
#include "runtime/view_text.h"

namespace palpate {
namespace {

struct Flags {
  std::string database;
  std::string demo;
  std::string model = "potential";
  std::uint16_t port = 0;
  double stiffness_scale = 1.0;
  ViewSessionOptions options;
};

ResponseDatabase shown(const Flags& flags) {
  if (flags.demo.empty() == flags.database.empty()) {
    throw InputError("give a database or --demo cylinder, one of the two");
  }
  if (flags.demo.empty()) {
    return read_database(flags.database);
  }
  if (flags.demo != "cylinder") {
    throw InputError(
        fmt::format("--demo {}: unknown body; known: cylinder", flags.demo));
  }
  return cylinder_body({});
}

ViewServerOptions server_options(const Flags& flags, const ViewSession& session) {
  ViewServerOptions options;
  options.port = flags.port;
  options.token = random_token();
  options.assets.assign(page_assets().begin(), page_assets().end());
  const std::string name = flags.demo.empty()
                               ? std::filesystem::path(flags.database).filename()
                               : std::filesystem::path(flags.demo);
  options.data = {{"/body.json", "application/json", body_text(session, name)},
                  {"/body.bin", "application/octet-stream",
                   body_bytes(session.database(), session.table())}};
  return options;
}

void run(const Flags& flags) {
  ViewSessionOptions options = flags.options;
  options.model = requested_model(flags.model);
  const ResponseDatabase database = shown(flags);
  ViewSession session(database, options);
  if (!(flags.stiffness_scale >= ViewRanges::kStiffnessMin &&
        flags.stiffness_scale <= ViewRanges::kStiffnessMax)) {
    throw InputError(fmt::format("--stiffness-scale {}: must lie in [{}, {}]",
                                 flags.stiffness_scale, ViewRanges::kStiffnessMin,
                                 ViewRanges::kStiffnessMax));
  }
  session.set_stiffness_scale(flags.stiffness_scale);
  MonotonicClock wall;
  LiveView live(session, wall);
  ViewServer server(server_options(flags, session), live);
  live.answer_through(server);
  const std::atomic<bool>& stop = heed_stop_signals();
  fmt::print("{}\n", server.address());
  std::fflush(stdout);  // who reads a pipe waits for it
  fmt::print(stderr, "open this address in a browser on this machine; Ctrl-C ends\n");
  server.run(stop);
}

}  // namespace

void add_view_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "view",
      "Show a database in a browser: press it with the mouse, on simulated "
      "time.");
  const auto flags = std::make_shared<Flags>();
  ViewSessionOptions& options = flags->options;
  command->add_option("database", flags->database, "Response database (HDF5)");
  command->add_option("--demo", flags->demo,
                      "A body without a file: cylinder, the paper's (section 5.2.4)");
  command->add_option("--port", flags->port, "On 127.0.0.1; 0: any free one")
      ->capture_default_str();
  command->add_option("--model", flags->model, "Local model: " + known_models())
      ->capture_default_str();
  command->add_option("--tool", options.tool, "Tool; may be left out if there is one");
  command->add_option("--slow-hz", options.slow_hz, "Rate of element updates [Hz]")
      ->capture_default_str();
  command->add_option("--fast-hz", options.fast_hz, "Rate of force updates [Hz]")
      ->capture_default_str();
  command->add_option("--force-max-n", options.force_max_n, "Largest force [N]")
      ->capture_default_str();
  command
      ->add_option("--stiffness-scale", flags->stiffness_scale,
                   "Forces are multiplied by it, at the start")
      ->capture_default_str();
  command->callback([flags] {
    run(*flags);
  });
}

}  // namespace palpate
