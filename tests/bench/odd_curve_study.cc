// Odd curves by the hundred thousand through all that `curve`, `batch` and Python's fit
// do: how many are fitted and refused, which end the process, and the slowest. Of each
// 250 the first ten are written and go through a session, report and page as well.
// Usage: odd_curve_study [curves [first seed [folder]]]
// With a folder nothing is fitted: the curves are written there, for the commands.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fitting/curve/fitted_response.h"
#include "fitting/curve/press_cycles.h"
#include "fitting/curve/segments.h"
#include "fitting/curve/split_presses.h"
#include "fitting/curve/time_effects.h"
#include "fitting/session/batch.h"
#include "fitting/session/press_fit.h"
#include "formats/base/error.h"
#include "tests/support/odd_curve.h"
#include "tests/support/synthetic_curve.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr unsigned kTogether = 250;  // curves of a process
constexpr unsigned kInSession = 10;  // of them

constexpr const char* kSession =
    "[read]\ndepth_column = \"x\"\ndepth_unit = \"mm\"\nforce_column = \"f\"\n"
    "force_unit = \"N\"\ntime_column = \"t\"\ntime_unit = \"s\"\n[indenter]\nshape = "
    "\"sphere\"\nradius_m = 5e-3\n"
    "[[run]]\nfiles = \"*.csv\"\n";

struct Tally {
  unsigned fitted = 0, refused = 0, slowest_seed = 0;
  double slowest_s = 0.0;
};

void fit_one(unsigned seed, Tally& tally) {
  const Measurement m = OddCurve(seed).make();
  const std::clock_t begin = std::clock();
  try {
    const Indenter sphere{.shape = "sphere", .radius_m = 5e-3};
    const PressFit press = fit_press(m, {.range = {}, .indenter = sphere, .frame = {}});
    (void)to_json(press, sphere).dump();
    if (!press.choice.fits.empty()) {
      (void)sample_patch(best_of(press), m, *rendered_tool(sphere), "");
    }
    (void)find_relaxation(m);
    (void)find_loop(m, press.approach, press.contact);
    (void)find_segments(m.depth_m);
    (void)summarise_cycles(split_presses(m), nullptr);
    ++tally.fitted;
  } catch (const Error&) {
    ++tally.refused;
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  if (seconds > tally.slowest_s) {
    tally.slowest_s = seconds;
    tally.slowest_seed = seed;
  }
}

void write_curve(const std::filesystem::path& folder, unsigned seed) {
  Measurement m = OddCurve(seed).make();
  while (m.time_s.size() < m.depth_m.size()) {
    m.time_s.push_back(0.01 * static_cast<double>(m.time_s.size()));
  }
  std::ofstream(folder / fmt::format("{}.csv", seed))
      << table_of(m, 1e3, 1.0, "x,f,t\n");
}

void fit_in_session(unsigned first, unsigned count) {
  const ScratchFolder folder;
  for (unsigned seed = first; seed < first + count; ++seed) {
    write_curve(folder.path(), seed);
  }
  std::ofstream(folder / "session.toml") << kSession;
  const Session session = read_session(folder / "session.toml");
  const BatchReport report = fit_session(session, 1, [](std::size_t) {});
  (void)batch_csv(session, report);
  (void)batch_json(session, report);
  (void)batch_page(session, report);
}

// In a process of its own; whether it came back.
bool fit_apart(unsigned first, unsigned count, Tally& all) {
  int ends[2];
  if (pipe(ends) != 0) {
    return false;
  }
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    Tally tally;
    for (unsigned seed = first; seed < first + count; ++seed) {
      fit_one(seed, tally);
    }
    fit_in_session(first, std::min(kInSession, count));
    const bool told = write(ends[1], &tally, sizeof tally) == sizeof tally;
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  Tally tally;
  const bool told = read(ends[0], &tally, sizeof tally) == sizeof tally;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!told || status != 0) {
    return false;
  }
  all.fitted += tally.fitted;
  all.refused += tally.refused;
  if (tally.slowest_s > all.slowest_s) {
    all.slowest_s = tally.slowest_s;
    all.slowest_seed = tally.slowest_seed;
  }
  return true;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using palpate::kTogether;
  const auto curves = static_cast<unsigned>(argc > 1 ? std::atoi(argv[1]) : 100000);
  const auto first = static_cast<unsigned>(argc > 2 ? std::atoi(argv[2]) : 1);
  if (argc > 3) {
    for (unsigned seed = first; seed < first + curves; ++seed) {
      palpate::write_curve(argv[3], seed);
    }
    return 0;
  }
  palpate::Tally all;
  unsigned died = 0;
  for (unsigned at = first; at < first + curves; at += kTogether) {
    const unsigned count = std::min(kTogether, first + curves - at);
    if (palpate::fit_apart(at, count, all)) {
      continue;
    }
    for (unsigned seed = at; seed < at + count; ++seed) {
      if (!palpate::fit_apart(seed, 1, all)) {
        fmt::print("seed {} ends the process\n", seed);
        ++died;
      }
    }
  }
  fmt::print(
      "{} curves: {} fitted, {} refused in words, {} ended the process; slowest "
      "{:.2f} CPU s (seed {})\n",
      curves, all.fitted, all.refused, died, all.slowest_s, all.slowest_seed);
  return died == 0 ? 0 : 1;
}
