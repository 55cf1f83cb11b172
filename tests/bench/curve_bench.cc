// What one evaluation of a stored curve costs, by its number of samples, and one fit:
// with the shares of its time that Ceres takes, and our law's evaluations within Ceres.

#include <chrono>
#include <cmath>
#include <random>

#include <benchmark/benchmark.h>

#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"
#include "fitting/numerics/least_squares.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

ResponseCurve hertz(int samples) {
  std::vector<double> depth;
  std::vector<double> force;
  for (int i = 0; i < samples; ++i) {
    depth.push_back(0.005 * i / (samples - 1));
    force.push_back(1000.0 * std::pow(depth.back(), 1.5));
  }
  return {depth, force};
}

void evaluate_curve(benchmark::State& state) {
  const ResponseCurve curve = hertz(static_cast<int>(state.range(0)));
  double depth = 0.0;
  for (auto _ : state) {
    depth = depth > 0.005 ? 0.0 : depth + 1.7e-6;
    benchmark::DoNotOptimize(curve.at(depth));
  }
}
BENCHMARK(evaluate_curve)->Arg(8)->Arg(20)->Arg(48);

void fit_curve(benchmark::State& state) {
  Measurement measurement;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.005);
  for (int i = 0; i < 1000; ++i) {
    const double depth = 0.006 * i / 999.0;
    measurement.depth_m.push_back(depth);
    measurement.force_n.push_back(1000.0 * std::pow(std::max(0.0, depth - 0.001), 1.5) +
                                  noise(random));
  }
  const SolverSeconds before = solver_seconds();
  const auto begin = std::chrono::steady_clock::now();
  for (auto _ : state) {
    const Approach approach = select_approach(measurement);
    benchmark::DoNotOptimize(fit_contact(approach, {}));
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const SolverSeconds after = solver_seconds();
  state.counters["ceres_share"] = (after.total - before.total) / seconds;
  state.counters["model_share"] = (after.evaluations - before.evaluations) / seconds;
}
BENCHMARK(fit_curve)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace palpate
