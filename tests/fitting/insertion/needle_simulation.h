// A needle as it is rendered: tick by tick, in energies, without closed forms.
//
//   tip    E(e) = c e^(n+1) / (n + 1), f = dE/de, e = z - z0 - L
//   flow   while f > Y(L), at frozen z: the membrane breaks, or the channel advances
//   shaft  spring of stiffness k_b, slides at Phi, starts to slide at rho Phi
//
// Y is the force of an unbroken membrane where L stands at one, else the layer's
// cutting force. Work of the hand is stored in tip and shaft, or spent: cutting,
// released at ruptures, friction.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

struct SimulatedLayer {
  double boundary_m = 0.0;  // [m] where it begins
  double membrane_n = 0.0;  // [N] of the membrane there
  double cutting_n = 0.0;   // [N]
  double friction_n_per_m = 0.0;
};

struct SimulatedTissue {
  double coefficient = 2.0e4, exponent = 1.5;  // c [N/m^n], n
  double contact_m = 3e-3;                     // z0
  std::vector<SimulatedLayer> layers;
  double static_ratio = 1.3;        // rho
  double presliding_n_per_m = 3e3;  // k_b
};

struct SimulatedNeedle {
  SimulatedTissue tissue;
  double channel_m = 0.0, stretch_m = 0.0, depth_m = 0.0;
  std::size_t broken = 0;  // membranes
  bool sticks = false;
  double work_j = 0.0, cut_j = 0.0, released_j = 0.0, friction_j = 0.0;
  std::vector<double> rupture_m;  // depths z of ruptures

  explicit SimulatedNeedle(SimulatedTissue t) : tissue(std::move(t)) {}

  [[nodiscard]] double deflection(double channel) const {
    return std::max(0.0, depth_m - tissue.contact_m - channel);
  }
  [[nodiscard]] double tip_energy(double e) const {
    return tissue.coefficient * std::pow(e, tissue.exponent + 1.0) /
           (tissue.exponent + 1.0);
  }
  [[nodiscard]] double tip_force(double e) const {
    return tissue.coefficient * std::pow(e, tissue.exponent);
  }
  [[nodiscard]] double slide_limit() const {
    const double l = std::clamp(depth_m - tissue.contact_m, 0.0, channel_m);
    double sum = 0.0;
    for (std::size_t k = 0; k < tissue.layers.size(); ++k) {
      const double end = k + 1 < tissue.layers.size() ? tissue.layers[k + 1].boundary_m
                                                      : channel_m + 1.0;
      sum += tissue.layers[k].friction_n_per_m *
             std::max(0.0, std::min(l, end) - tissue.layers[k].boundary_m);
    }
    return sum;
  }
  [[nodiscard]] double stored() const {
    return tip_energy(deflection(channel_m)) +
           0.5 * tissue.presliding_n_per_m * stretch_m * stretch_m;
  }
  [[nodiscard]] double force() const {
    return tip_force(deflection(channel_m)) + tissue.presliding_n_per_m * stretch_m;
  }

  void flow() {
    while (true) {
      const double f = tip_force(deflection(channel_m));
      const bool at_membrane = broken < tissue.layers.size() &&
                               channel_m >= tissue.layers[broken].boundary_m - 1e-12;
      if (at_membrane) {
        if (!(f > tissue.layers[broken].membrane_n)) {
          return;
        }
        ++broken;
        rupture_m.push_back(depth_m);
        continue;
      }
      if (broken == 0) {
        return;
      }
      const double cut = tissue.layers[broken - 1].cutting_n;
      if (!(f > cut * (1.0 + 1e-12))) {
        return;
      }
      const double target = depth_m - tissue.contact_m -
                            std::pow(cut / tissue.coefficient, 1.0 / tissue.exponent);
      const double next = broken < tissue.layers.size()
                              ? std::min(target, tissue.layers[broken].boundary_m)
                              : target;
      const double before = tip_energy(deflection(channel_m));
      const double crack = cut * (next - channel_m);
      cut_j += crack;
      channel_m = next;
      released_j += before - tip_energy(deflection(channel_m)) - crack;
    }
  }

  void tick(double depth) {
    const double before = stored(), way = depth - depth_m;
    sticks = sticks || way * stretch_m < 0.0;  // from a reversal until it slides again
    stretch_m += way;
    depth_m = depth;
    work_j += stored() - before;
    flow();
    const double limit = slide_limit() / tissue.presliding_n_per_m;
    if (std::abs(stretch_m) > (sticks ? tissue.static_ratio * limit : limit)) {
      const double energy = stored();
      stretch_m = std::copysign(limit, stretch_m);
      friction_j += energy - stored();
      sticks = false;
    }
  }
};

struct SimulatedRun {
  double free_m = 3e-3;                  // [m] travel before contact
  std::vector<double> deepest_m{25e-3};  // [m] from the start, of each pass
  bool extracts = true;                  // also after the last pass
  double step_m = 2e-5;                  // [m] between samples
  int ticks = 40;                        // of the simulation, a sample
  double noise_n = 0.01, rho = 0.0, drift_n = 0.0, offset_n = 0.1;
};

/// Sampled motion there and back, at constant speed of 1 mm/s.
inline Measurement simulate_insertion(SimulatedNeedle& needle, const SimulatedRun& run,
                                      unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Measurement m;
  const double tick_m = run.step_m / run.ticks;
  double depth = 0.0, noise = normal(generator);
  needle.depth_m = 0.0;
  const auto sample = [&] {
    m.depth_m.push_back(depth);
    m.time_s.push_back(static_cast<double>(m.time_s.size()) * run.step_m / 1e-3);
    m.force_n.push_back(needle.force() + run.offset_n + run.noise_n * noise);
    noise = run.rho * noise + std::sqrt(1.0 - run.rho * run.rho) * normal(generator);
  };
  sample();
  const auto move = [&](double to) {
    const auto ticks = static_cast<long>(std::lround(std::abs(to - depth) / tick_m));
    const double from = depth;
    for (long i = 1; i <= ticks; ++i) {
      depth = from + (to - from) * static_cast<double>(i) / static_cast<double>(ticks);
      needle.tick(depth);
      if (i % run.ticks == 0) {
        sample();
      }
    }
  };
  for (std::size_t p = 0; p < run.deepest_m.size(); ++p) {
    move(run.deepest_m[p]);
    if (run.extracts || p + 1 < run.deepest_m.size()) {
      move(0.0);
    }
  }
  for (std::size_t i = 0; i < m.force_n.size(); ++i) {
    m.force_n[i] += run.drift_n * m.time_s[i] / m.time_s.back();
  }
  return m;
}

}  // namespace palpate
