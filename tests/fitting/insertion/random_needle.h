// Random insertions of known truth, and whether a fit's intervals hold it.
#pragma once

#include <random>

#include "fitting/insertion/needle_fit.h"
#include "tests/fitting/insertion/needle_simulation.h"
#include "tests/support/interval_coverage.h"

namespace palpate {

struct RandomNeedle {
  SimulatedTissue tissue;
  SimulatedRun run;
};

/// One to three layers. Membranes break at 2 to 5 mm of deflection.
inline RandomNeedle random_needle(unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> share;
  const auto between = [&](double low, double high) {
    return low + (high - low) * share(generator);
  };
  RandomNeedle needle;
  SimulatedTissue& tissue = needle.tissue;
  const int layers = 1 + static_cast<int>(3.0 * share(generator));
  const double skin_n = between(1.0, 3.0);
  tissue.exponent = between(1.2, 2.2);
  tissue.coefficient = skin_n / std::pow(between(2e-3, 5e-3), tissue.exponent);
  tissue.contact_m = between(2e-3, 4e-3);
  double boundary = 0.0;
  for (int k = 0; k < layers; ++k) {
    const double membrane = k == 0 ? skin_n : skin_n * between(0.4, 0.9);
    tissue.layers.push_back({.boundary_m = boundary,
                             .membrane_n = membrane,
                             .cutting_n = membrane * between(0.15, 0.5),
                             .friction_n_per_m = between(10.0, 40.0)});
    boundary += between(6e-3, 9e-3);
  }
  for (int k = 1; k < layers; ++k) {  // a layer is cut with less than its end holds
    const auto at = static_cast<std::size_t>(k);
    tissue.layers[at - 1].cutting_n =
        std::min(tissue.layers[at - 1].cutting_n, 0.5 * tissue.layers[at].membrane_n);
  }
  tissue.static_ratio = between(1.15, 1.5);
  tissue.presliding_n_per_m = between(1.5e3, 4e3);
  const double first = tissue.contact_m + boundary + between(2e-3, 5e-3);
  needle.run.deepest_m = {first, first + between(3e-3, 6e-3)};
  needle.run.offset_n = between(-0.3, 0.3);
  return needle;
}

/// What intervals held, and ruptures that were not there or not found.
struct NeedleCoverage : IntervalCoverage {
  using IntervalCoverage::add;
  int runs = 0, wrong_count = 0, false_ruptures = 0, missed = 0;
  void add(const NeedleFit& fit, const SimulatedNeedle& needle,
           const SimulatedRun& run) {
    const SimulatedTissue& t = needle.tissue;
    ++runs;
    const int more = static_cast<int>(fit.ruptures.size()) -
                     static_cast<int>(needle.rupture_m.size());
    if (more != 0) {
      ++wrong_count;
      (more > 0 ? false_ruptures : missed) += std::abs(more);
      return;
    }
    add("coefficient", fit.coefficient, t.coefficient);
    add("exponent", fit.exponent, t.exponent);
    add("contact point", fit.contact_m, t.contact_m);
    for (std::size_t k = 0; k < fit.ruptures.size(); ++k) {
      add("rupture depth", fit.ruptures[k].depth_m, needle.rupture_m[k] - t.contact_m);
      add("rupture force", fit.ruptures[k].force_n, t.layers[k].membrane_n);
      if (k > 0) {
        add("boundary", fit.ruptures[k].boundary_m, t.layers[k].boundary_m);
      }
      add("cutting force", fit.layers[k].cutting_n, t.layers[k].cutting_n);
      add("friction per length", fit.layers[k].friction_n_per_m,
          t.layers[k].friction_n_per_m);
    }
    add("static ratio", fit.static_ratio, t.static_ratio);
    add("presliding stiffness", fit.presliding_n_per_m, t.presliding_n_per_m);
    add("drift", fit.baselines[0].drift_n, run.drift_n);
  }
};

}  // namespace palpate
