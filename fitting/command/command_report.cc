// palpate-fit report: all runs of a session in, one page for a browser out.
#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "fitting/command/commands.h"
#include "fitting/session/batch.h"
#include "formats/base/atomic_file.h"

namespace palpate {
namespace {

struct ReportOptions {
  std::string session, output, cycle;
  std::size_t plots = 200;
};

void run_report(const ReportOptions& options) {
  Session session = read_session(options.session);
  if (!options.cycle.empty()) {
    session.fit.cycle = parse_cycle(options.cycle);
  }
  const BatchReport report = fit_session(
      session, std::max(1U, std::thread::hardware_concurrency()), [](std::size_t) {});
  const std::string page = batch_page(session, report, options.plots);
  AtomicFile atomic(options.output);
  atomic.write(std::as_bytes(std::span(page)));
  atomic.commit();
  fmt::print("wrote {} ({} bytes)\n", options.output, page.size());
}

}  // namespace

void add_fit_report_command(Command app) {
  auto options = std::make_shared<ReportOptions>();
  Command command = app.add_subcommand(
      "report", "Write a page with data, fit, band and residuals of a session.");
  command.add_option("SESSION", options->session, "session file (TOML)").required();
  command.add_option("-o,--output", options->output, "page to write (HTML)").required();
  command.add_option("--cycle", options->cycle,
                     "presses fitted of each file: first, last, all or a number; "
                     "default: the session's, else all");
  command.add_option("--plots", options->plots, "runs drawn at most").show_default();
  command.callback([options] {
    run_report(*options);
  });
}

}  // namespace palpate
