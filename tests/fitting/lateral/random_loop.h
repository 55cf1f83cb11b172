// Random lateral loops of known truth, and whether a fit's intervals hold it.
#pragma once

#include <random>

#include "fitting/lateral/lateral_fit.h"
#include "tests/fitting/lateral/loop_simulation.h"
#include "tests/support/interval_coverage.h"

namespace palpate {

struct RandomLoop {
  SimulatedContact contact;
  SimulatedMotion motion;
};

/// Loops of 1 to 4 cycles, 2 to 8 presliding lengths wide, of either law.
inline RandomLoop random_loop(unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> share;
  const auto between = [&](double low, double high) {
    return low + (high - low) * share(generator);
  };
  RandomLoop loop;
  SimulatedContact& contact = loop.contact;
  contact.stiffness_n_per_m = std::exp(between(std::log(100.0), std::log(1e4)));
  contact.friction = between(0.1, 1.2);
  contact.normal_n = std::exp(between(std::log(0.1), std::log(5.0)));
  contact.partial_slip = seed % 2 == 0;
  contact.instrument_n_per_m =
      seed % 3 == 0 ? contact.stiffness_n_per_m * between(2.0, 20.0) : 0.0;
  SimulatedMotion& motion = loop.motion;
  motion.amplitude_m = contact.presliding_m() * between(2.0, 8.0);
  motion.centre_m = motion.amplitude_m * between(-1.0, 1.0);
  motion.cycles = 1.5 + std::floor(4.0 * share(generator));
  motion.samples_per_cycle = 150 + static_cast<int>(450.0 * share(generator));
  motion.sine = seed % 5 < 2;
  motion.phase = share(generator);
  motion.offset_n = contact.slip_n() * between(-0.5, 0.5);
  return loop;
}

/// What intervals held, and what else was found.
struct LoopCoverage : IntervalCoverage {
  using IntervalCoverage::add;
  int wrong_law = 0, laws_alike = 0, warned = 0;

  void add(const LateralFit& fit, const RandomLoop& truth, const SimulatedLoop& loop) {
    const bool is_partial = fit.better.law == ContactLaw::kPartialSlip;
    laws_alike += fit.laws_differ() ? 0 : 1;
    wrong_law += fit.laws_differ() && is_partial != truth.contact.partial_slip ? 1 : 0;
    const RunFit& run = fit.better.runs.front();
    for (const std::string& note : run.notes) {
      warned += note.find("differ") != std::string::npos ? 1 : 0;
    }
    add("stiffness k", run.stiffness_n_per_m, truth.contact.stiffness_n_per_m);
    add("friction mu", fit.better.friction, truth.contact.friction);
    add("presliding length", run.presliding_m, truth.contact.presliding_m());
    add("drift", run.drift_n, truth.motion.drift_n);
    double loss = 0.0;
    for (const double one : loop.loss_j) {
      loss += one / static_cast<double>(loop.loss_j.size());
    }
    add("loss, measured", run.loss_j, loss);
    add("loss, modelled", run.modelled_loss_j, loss);
  }
};

}  // namespace palpate
