// palpate-fit batch: all runs of a session in, tables and a page out.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "fitting/command/commands.h"
#include "fitting/session/batch.h"
#include "fitting/session/curve_tables.h"
#include "fitting/session/mean_curves.h"
#include "fitting/session/session_machine.h"
#include "formats/base/atomic_file.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

struct BatchOptions {
  std::string session, output, cycle;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  std::size_t plots = 200;
  bool quiet = false;
  bool json = false;
};

void write_file(const std::filesystem::path& file, const std::string& text) {
  AtomicFile atomic(file);
  atomic.write(std::as_bytes(std::span(text)));
  atomic.commit();
}

// On stderr, at most twice a second, and at the end.
std::function<void(std::size_t)> progress_of(std::size_t runs, bool quiet) {
  auto printed = std::chrono::steady_clock::now();
  return [runs, quiet, printed](std::size_t done) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (!quiet && (done == runs || now - printed > std::chrono::milliseconds(500))) {
      printed = now;
      fmt::print(stderr, "{} of {} runs\n", done, runs);
    }
  };
}

void print_lines(const char* label, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    fmt::print("{:<6} {}\n", label, line);
  }
}

void print_batch(const Session& session, const BatchReport& report,
                 const std::string& output) {
  if (report.frame) {
    fmt::print("frame  {}\n", describe_frame(report.frame));
  }
  print_lines("place", describe_registration(session));
  std::size_t use = 0, check = 0;
  for (const RunResult& run : report.runs) {
    use += run.rating.verdict == Verdict::kUse ? 1 : 0;
    check += run.rating.verdict == Verdict::kCheck ? 1 : 0;
    if (!run.bad.empty()) {
      fmt::print("bad    {}\n", run.bad);
    }
  }
  fmt::print("runs   {}: {} to use, {} to check, {} to skip\n", report.runs.size(), use,
             check, report.runs.size() - use - check);
  const MeanCurves means = mean_curves(report);
  if (const std::string text = left_out_text(means); !text.empty()) {
    fmt::print("means  {}\n", text);
  }
  fmt::print("time   {:.3g} s, {:.3g} runs per second\n", report.seconds,
             static_cast<double>(report.runs.size()) / report.seconds);
  fmt::print(
      "wrote  {0}/results.csv, {0}/results.json, {0}/curves.csv, {0}/mean_curves.csv, "
      "{0}/cycles.csv, {0}/report.html\n",
      output);
}

void run_batch(const BatchOptions& options) {
  Session session = read_session(options.session);
  if (!options.cycle.empty()) {
    session.fit.cycle = parse_cycle(options.cycle);
  }
  std::error_code failed;
  std::filesystem::create_directories(options.output, failed);
  if (failed) {
    throw InputError(
        fmt::format("{}: cannot be made: {}", options.output, failed.message()));
  }
  const BatchReport report = fit_session(
      session, options.threads, progress_of(session.run.size(), options.quiet));
  const std::filesystem::path folder = options.output;
  const std::string json = batch_json(session, report);
  write_file(folder / "results.csv", batch_csv(session, report));
  write_file(folder / "results.json", json + "\n");
  write_file(folder / "curves.csv", curves_csv(report));
  write_file(folder / "mean_curves.csv", mean_curves_csv(report));
  write_file(folder / "cycles.csv", cycles_csv(report));
  write_file(folder / "report.html", batch_page(session, report, options.plots));
  if (options.json) {
    fmt::print("{}\n", json);
  } else {
    fmt::print("{}", describe_notes(session));
    print_batch(session, report, folder.lexically_normal().string());
  }
  const bool all_bad =
      std::all_of(report.runs.begin(), report.runs.end(), [](const RunResult& run) {
        return !run.bad.empty();
      });
  if (all_bad) {
    throw InputError(fmt::format("{}: no run could be read or fitted; {} says why",
                                 options.session, (folder / "results.csv").string()));
  }
}

}  // namespace

void add_batch_command(Command app) {
  auto options = std::make_shared<BatchOptions>();
  Command command = app.add_subcommand(
      "batch", "Fit all runs of a session; a bad file is listed, not fatal.");
  command.add_option("SESSION", options->session, "session file (TOML)").required();
  command.add_option("-o,--output", options->output, "folder for the results")
      .required();
  command.add_option("--threads", options->threads, "runs fitted at a time")
      .in_range(1U, 256U);
  command.add_option("--cycle", options->cycle,
                     "presses fitted of each file: first, last, all or a number; "
                     "default: the session's, else all");
  command.add_option("--plots", options->plots, "runs drawn in report.html at most")
      .show_default();
  command.add_flag("--quiet", options->quiet, "no progress on stderr");
  command.add_flag("--json", options->json, "print results.json as well");
  command.callback([options] {
    run_batch(*options);
  });
}

}  // namespace palpate
