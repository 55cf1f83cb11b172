// Measurements with a known answer.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <fmt/format.h>

#include "formats/database/response_database.h"

namespace palpate {

/// Force whose contact part reaches 1 N at 5 mm depth.
struct SyntheticCurve {
  double exponent = 1.5;
  double noise_n = 0.005;  ///< [N] standard deviation
  double rho = 0.0;        ///< [-] of the noise of neighbours
  double drift_n = 0.0;    ///< [N] over the whole travel, linear
  double free_m = 2e-3;    ///< [m] travel before contact
  double offset_n = 0.0;   ///< [N]
  int samples = 350;
};

constexpr double kSyntheticDepth = 5e-3;  // [m]

inline Measurement synthetic(const SyntheticCurve& c, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const double travel = c.free_m + kSyntheticDepth;
  Measurement m;
  double noise = normal(generator);
  for (int i = 0; i < c.samples; ++i) {
    const double x = travel * i / (c.samples - 1);
    const double d = std::max(0.0, x - c.free_m) / kSyntheticDepth;
    m.depth_m.push_back(x);
    m.force_n.push_back(c.offset_n + c.drift_n * x / travel + std::pow(d, c.exponent) +
                        c.noise_n * noise);
    noise = c.rho * noise + std::sqrt(1.0 - c.rho * c.rho) * normal(generator);
  }
  return m;
}

/// A table of columns x [mm] and f [N] times these factors, and t [s] where there are
/// times and the header names them.
inline std::string table_of(const Measurement& m, double depth = 1e3,
                            double force = 1.0, const std::string& header = "x,f\n") {
  const bool times = header.find('t') != std::string::npos && !m.time_s.empty();
  std::string text = header;
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    text += fmt::format("{},{}", depth * m.depth_m[i], force * m.force_n[i]);
    text += times ? fmt::format(",{}\n", m.time_s[i]) : "\n";
  }
  return text;
}

}  // namespace palpate
