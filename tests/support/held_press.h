// A press with a hold, as measured on a body whose relaxation is known.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/database/response_database.h"
#include "tests/support/relaxation_reference.h"

namespace palpate {

/// Hertz's curve from 0.6 mm of free travel to 5 mm of depth.
struct HeldPress {
  PronyTerms2 terms = kPork;
  double speed_m_per_s = 1e-3;
  double rate_hz = 20.0;
  double hold_s = 10.0;
  double force_n = 1.0;   ///< [N] instantaneous, at 5 mm
  double noise_n = 3e-3;  ///< [N] standard deviation, white
};

inline Measurement measured(const HeldPress& press, std::mt19937& generator) {
  constexpr int kSteps = 20;  // to a sample
  constexpr double kFree = 6e-4, kDepth = 5e-3;
  std::normal_distribution<double> noise(0.0, press.noise_n);
  RelaxationReference reference(press.terms);
  const double press_s = (kFree + kDepth) / press.speed_m_per_s;
  const double step_s = 1.0 / (press.rate_hz * kSteps);
  Measurement m;
  for (int i = 0; i * step_s <= press_s + press.hold_s; ++i) {
    const double x = press.speed_m_per_s * std::min(i * step_s, press_s);
    const double depth = std::max(0.0, x - kFree) / kDepth;
    const double force = reference.step(press.force_n * std::pow(depth, 1.5), step_s);
    if (i % kSteps == 0) {
      m.time_s.push_back(i * step_s);
      m.depth_m.push_back(x);
      m.force_n.push_back(force + noise(generator));
    }
  }
  return m;
}

}  // namespace palpate
