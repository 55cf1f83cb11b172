// A spring that relaxes, pressed in ramps with holds: the closed form of the
// quasi-linear law.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

struct Staircase {
  struct Step {
    double rise_m = 0.0;  ///< negative: back
    double hold_s = 0.0;
  };

  std::vector<Step> steps;
  double speed_m_per_s = 1e-4, rate_hz = 5.0, noise_n = 1e-3;

  static constexpr double kFree = 3e-4;        ///< [m] before contact
  static constexpr double kStiffness = 300.0;  ///< [N/m] at once
  static constexpr double kBaseline = 0.01;    ///< [N]
  static constexpr double kG[] = {0.3, 0.25}, kTau[] = {6.0, 120.0};

  [[nodiscard]] Measurement make(unsigned seed) const {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    const std::vector<Corner> way = corners();
    Measurement m;
    for (int i = 0; i / rate_hz <= way.back().time_s; ++i) {
      const double t = i / rate_hz;
      m.time_s.push_back(t);
      m.depth_m.push_back(depth(way, t));
      m.force_n.push_back(kBaseline + force(way, t) + noise_n * normal(generator));
    }
    return m;
  }

 private:
  struct Corner {
    double time_s = 0.0, depth_m = 0.0;
  };

  // Ends of ramps and holds, and where contact begins or ends.
  [[nodiscard]] std::vector<Corner> corners() const {
    std::vector<Corner> way{{0.0, 0.0}};
    const auto go = [&](double to_m) {
      const double seconds = std::abs(to_m - way.back().depth_m) / speed_m_per_s;
      way.push_back({way.back().time_s + seconds, to_m});
    };
    for (const Step& step : steps) {
      const double from_m = way.back().depth_m, to_m = from_m + step.rise_m;
      if ((from_m - kFree) * (to_m - kFree) < 0.0) {
        go(kFree);
      }
      go(to_m);
      way.push_back({way.back().time_s + step.hold_s, to_m});
    }
    return way;
  }

  static double depth(const std::vector<Corner>& way, double t) {
    double x = 0.0;
    for (std::size_t i = 1; i < way.size() && way[i - 1].time_s <= t; ++i) {
      const double seconds = way[i].time_s - way[i - 1].time_s;
      const double share =
          seconds > 0.0 ? std::min(1.0, (t - way[i - 1].time_s) / seconds) : 1.0;
      x = way[i - 1].depth_m + share * (way[i].depth_m - way[i - 1].depth_m);
    }
    return x;
  }

  // Sum over stretches of the elastic force's rate times the integral of G(t - s).
  static double force(const std::vector<Corner>& way, double t) {
    double sum = 0.0;
    for (std::size_t i = 1; i < way.size() && way[i - 1].time_s < t; ++i) {
      const double begin = way[i - 1].time_s, end = std::min(t, way[i].time_s);
      const double seconds = way[i].time_s - begin;
      const double rise = std::max(0.0, way[i].depth_m - kFree) -
                          std::max(0.0, way[i - 1].depth_m - kFree);
      if (seconds > 0.0) {
        sum += kStiffness * rise / seconds * (response(t - begin) - response(t - end));
      }
    }
    return sum;
  }

  static double response(double t) {
    double sum = t;
    for (int k = 0; k < 2; ++k) {
      sum -= kG[k] * (t + kTau[k] * std::expm1(-t / kTau[k]));
    }
    return sum;
  }
};

}  // namespace palpate
