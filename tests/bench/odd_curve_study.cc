// Odd curves by the hundred thousand through all that `curve`, `batch` and Python's fit
// do: how many are fitted and refused, which end the process, and the slowest.
// Usage: odd_curve_study [curves [first seed]]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fitting/curve/press_cycles.h"
#include "fitting/curve/segments.h"
#include "fitting/curve/split_presses.h"
#include "fitting/curve/time_effects.h"
#include "fitting/session/press_fit.h"
#include "formats/base/error.h"
#include "tests/support/odd_curve.h"

namespace palpate {
namespace {

constexpr unsigned kTogether = 250;  // curves of a process

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
