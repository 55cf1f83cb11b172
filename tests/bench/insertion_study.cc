// Needle insertions of known truth: how often 95 % intervals hold it, and whether
// ruptures are found, none too many.
// Usage: insertion_study [runs [first seed]]
#include <chrono>
#include <cstdlib>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "tests/fitting/insertion/random_needle.h"

namespace palpate {
namespace {

struct Case {
  const char* name;
  double noise_n = 0.01, rho = 0.0, drift_n = 0.0;
};

void report(const Case& c, unsigned runs, unsigned first_seed) {
  NeedleCoverage coverage;
  double seconds = 0.0;
  int failed = 0;
  for (unsigned seed = first_seed; seed < first_seed + runs; ++seed) {
    RandomNeedle random = random_needle(seed);
    random.run.noise_n = c.noise_n;
    random.run.rho = c.rho;
    random.run.drift_n = c.drift_n;
    SimulatedNeedle needle(random.tissue);
    const Measurement m = simulate_insertion(needle, random.run, 77 + seed);
    const auto start = std::chrono::steady_clock::now();
    try {
      const NeedleFit fit = fit_needle(find_needle_path({m}));
      const int before = coverage.wrong_count;
      coverage.add(fit, needle, random.run);
      if (std::getenv("VERBOSE") != nullptr) {
        if (coverage.wrong_count != before || fit.rms_n > 1.15 * c.noise_n) {
          fmt::print(
              "seed {}: {} of {} ruptures, dropped {}, rms {:.4f}, converged {}\n",
              seed, fit.ruptures.size(), needle.rupture_m.size(), fit.dropped,
              fit.rms_n, fit.converged);
        }
      }
    } catch (const Error& error) {
      ++failed;
      fmt::print("seed {}: {}\n", seed, error.what());
    }
    seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  fmt::print("{}: {} runs, {} refused, {} ruptures too many, {} missed, {:.0f} ms\n",
             c.name, runs, failed, coverage.false_ruptures, coverage.missed,
             1e3 * seconds / runs);
  coverage.print();
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const unsigned runs = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 200;
  const unsigned seed = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 30001;
  for (const palpate::Case& c :
       {palpate::Case{"white noise of 0.01 N"},
        palpate::Case{"autocorrelation 0.5", 0.01, 0.5},
        palpate::Case{"autocorrelation 0.9", 0.01, 0.9},
        palpate::Case{"white, drift of 0.2 N", 0.01, 0.0, 0.2},
        palpate::Case{"autocorrelation 0.8, drift", 0.02, 0.8, -0.2}}) {
    report(c, runs, seed);
  }
}
