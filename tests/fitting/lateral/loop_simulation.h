// A contact that is moved sideways, as springs in parallel of which each slides at a
// force of its own (Iwan 1966). The springs move step by step, without closed forms of
// loops.
//
// One spring is a sharp slip. Partial slip of Cattaneo and Mindlin is a share
// phi(r) dr = (1 - r/x_s)^(-1/2) / (2 x_s) dr of springs that slide at the stretch r.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "fitting/lateral/lateral_path.h"

namespace palpate {

struct SimulatedContact {
  double stiffness_n_per_m = 2000.0;  // k
  double friction = 0.5;              // mu
  double normal_n = 1.0;
  bool partial_slip = false;
  double instrument_n_per_m = 0.0;  // in series; 0: rigid

  [[nodiscard]] double slip_n() const { return friction * normal_n; }
  [[nodiscard]] double presliding_m() const { return slip_n() / stiffness_n_per_m; }
};

struct SimulatedMotion {
  double amplitude_m = 1e-3, centre_m = 0.0;
  double cycles = 3.0;
  int samples_per_cycle = 400;
  bool sine = false;
  double phase = 0.0;  // [-] of a sample, at which the first one lies
  double noise_n = 0.0, rho = 0.0, drift_n = 0.0, offset_n = 0.0;
  double relaxes = 0.0;  // [-] share of the normal force that is lost until the end
};

class SimulatedSprings {
 public:
  explicit SimulatedSprings(const SimulatedContact& contact)
      : k_(contact.stiffness_n_per_m) {
    const int count = contact.partial_slip ? 200 : 1;
    const double x_s = 1.5 * contact.presliding_m();
    for (int i = 0; i < count; ++i) {
      // Equal shares of springs: the distribution's function is 1 - (1 - r/x_s)^(1/2).
      const double left = 1.0 - (i + 0.5) / count;
      limit_m_.push_back(contact.partial_slip ? x_s * (1.0 - left * left)
                                              : contact.presliding_m());
      stretch_m_.push_back(0.0);
    }
  }
  [[nodiscard]] double force_after(double step_m) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < limit_m_.size(); ++i) {
      sum += std::clamp(stretch_m_[i] + step_m, -limit_m_[i], limit_m_[i]);
    }
    return k_ * sum / static_cast<double>(limit_m_.size());
  }
  void step(double step_m) {
    for (std::size_t i = 0; i < limit_m_.size(); ++i) {
      stretch_m_[i] = std::clamp(stretch_m_[i] + step_m, -limit_m_[i], limit_m_[i]);
    }
  }

 private:
  double k_;
  std::vector<double> limit_m_, stretch_m_;
};

// Machine, instrument and contact in series; the machine's way from where it began.
class SimulatedRig {
 public:
  explicit SimulatedRig(const SimulatedContact& contact)
      : instrument_n_per_m_(contact.instrument_n_per_m), springs_(contact) {}

  void move_to(double way_m) {
    double step = way_m - machine_m_;
    if (instrument_n_per_m_ > 0.0) {
      double low = std::min(0.0, step) * 2.0 - 1e-9,
             high = std::max(0.0, step) * 2.0 + 1e-9;
      for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        const double reached =
            contact_m_ + middle + springs_.force_after(middle) / instrument_n_per_m_;
        (reached < way_m ? low : high) = middle;
      }
      step = 0.5 * (low + high);
    }
    springs_.step(step);
    contact_m_ += step;
    const double force = springs_.force_after(0.0);
    work_j_ += 0.5 * (force_n_ + force) * (way_m - machine_m_);
    force_n_ = force;
    machine_m_ = way_m;
  }
  [[nodiscard]] double force_n() const { return force_n_; }
  [[nodiscard]] double work_j() const { return work_j_; }

 private:
  double instrument_n_per_m_;
  SimulatedSprings springs_;
  double machine_m_ = 0.0, contact_m_ = 0.0, force_n_ = 0.0, work_j_ = 0.0;
};

// Way over the number of cycles done: up, down, and back to the centre.
inline double simulated_way(const SimulatedMotion& motion, double cycles) {
  const double turn = cycles - std::floor(cycles);
  const double triangle = turn < 0.25   ? 4.0 * turn
                          : turn < 0.75 ? 2.0 - 4.0 * turn
                                        : 4.0 * turn - 4.0;
  return motion.amplitude_m *
         (motion.sine ? std::sin(2.0 * std::numbers::pi * turn) : triangle);
}

struct SimulatedLoop {
  LateralRun run;
  std::vector<double> loss_j;  // of each whole cycle, from its first turn on
};

inline SimulatedLoop simulate_loop(const SimulatedContact& contact,
                                   const SimulatedMotion& motion, unsigned seed) {
  constexpr int kFine = 16;  // steps between samples
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  SimulatedLoop loop;
  SimulatedRig rig(contact);
  const int count = static_cast<int>(motion.cycles * motion.samples_per_cycle) + 1;
  const double fresh = std::sqrt(1.0 - motion.rho * motion.rho);
  double shared = normal(generator), cycles = 0.0;
  std::vector<double> work_at_turn;
  for (int i = 0; i < count; ++i) {
    const double from = cycles, to = (i + motion.phase) / motion.samples_per_cycle;
    for (int j = 1; j <= kFine; ++j) {
      cycles = from + (to - from) * j / kFine;
      const double turns = std::floor(2.0 * cycles + 0.5);
      if (turns > static_cast<double>(work_at_turn.size())) {
        rig.move_to(simulated_way(motion, 0.5 * turns - 0.25));  // the turn itself
        work_at_turn.push_back(rig.work_j());
      }
      rig.move_to(simulated_way(motion, cycles));
    }
    const double clock = static_cast<double>(i) / (count - 1);
    const double share = 1.0 - motion.relaxes * clock;
    shared = motion.rho * shared + fresh * normal(generator);
    loop.run.displacement_m.push_back(motion.centre_m + simulated_way(motion, to));
    loop.run.force_n.push_back(rig.force_n() * share + motion.offset_n +
                               motion.drift_n * clock + motion.noise_n * shared);
    loop.run.time_s.push_back(0.01 * i);
    loop.run.normal_n.push_back(contact.normal_n * share);
  }
  for (std::size_t i = 2; i < work_at_turn.size(); i += 2) {
    loop.loss_j.push_back(work_at_turn[i] - work_at_turn[i - 2]);
  }
  return loop;
}

}  // namespace palpate
