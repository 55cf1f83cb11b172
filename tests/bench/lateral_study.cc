// Lateral loops of known truth: how often 95 % intervals hold it, and whether the law
// of contact is recognised. Usage: lateral_study [runs [first seed]]
#include <chrono>
#include <cstdlib>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "tests/fitting/lateral/random_loop.h"

namespace palpate {
namespace {

struct Case {
  const char* name;
  double noise = 0.02, rho = 0.0, drift = 0.0;  // of the sliding force
};

void report(const Case& c, unsigned runs, unsigned first_seed) {
  LoopCoverage coverage;
  double seconds = 0.0;
  int failed = 0;
  for (unsigned seed = first_seed; seed < first_seed + runs; ++seed) {
    RandomLoop random = random_loop(seed);
    const double slip_n = random.contact.slip_n();
    random.motion.noise_n = c.noise * slip_n;
    random.motion.rho = c.rho;
    random.motion.drift_n = c.drift * slip_n;
    const SimulatedLoop loop = simulate_loop(random.contact, random.motion, 77 + seed);
    const auto start = std::chrono::steady_clock::now();
    try {
      const double instrument = random.contact.instrument_n_per_m;
      const FrameCompliance frame = linear_frame(instrument > 0.0 ? instrument : 1.0);
      const LateralFit fit =
          fit_lateral({loop.run}, instrument > 0.0 ? &frame : nullptr);
      coverage.add(fit, random, loop);
      if (std::getenv("VERBOSE") != nullptr) {
        const IntervalEstimate& k = fit.better.runs.front().stiffness_n_per_m;
        fmt::print(
            "seed {}: {} deviance {:.1f}, k {:.2f} sd off, cycles {}, "
            "rms {:.3f} of noise\n",
            seed, law_name(fit.better.law), fit.deviance,
            (k.value - random.contact.stiffness_n_per_m) / k.sd, random.motion.cycles,
            fit.better.rms_n / random.motion.noise_n);
      }
    } catch (const Error& error) {
      ++failed;
      fmt::print("seed {}: {}\n", seed, error.what());
    }
    seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  fmt::print(
      "{}: {} runs, {} refused, {} of the wrong law, {} undecided, {} warned of "
      "their cycles, {:.0f} ms\n",
      c.name, runs, failed, coverage.wrong_law, coverage.laws_alike, coverage.warned,
      1e3 * seconds / runs);
  coverage.print();
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const unsigned runs = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 200;
  const unsigned seed = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 30001;
  for (const palpate::Case& c :
       {palpate::Case{"white noise of 2 %"},
        palpate::Case{"autocorrelation 0.5", 0.02, 0.5},
        palpate::Case{"autocorrelation 0.9", 0.02, 0.9},
        palpate::Case{"white, drift of 20 %", 0.02, 0.0, 0.2},
        palpate::Case{"5 %, autocorrelation 0.8, drift", 0.05, 0.8, -0.2}}) {
    palpate::report(c, runs, seed);
  }
}
