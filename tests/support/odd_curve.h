// Curves that no law follows, by chance: what load cells below their resolution, empty
// presses, switches, stuck stages and broken exports write.
//
// A curve is a way of the tool times a force, both by chance:
// - ways: ramp, staircase, press and hold, press and release, two presses, reversed,
//   still, to and fro between two depths, each depth several times, by chance;
// - forces: nothing, one value, flicker, steps, plateaus, a law in steps of a sensor, a
//   dome, a fall, chance.
//
// Some readings are wild or no numbers, or far from zero. Units are from far too small
// to far too large. Times rise, stand, jump or run backwards.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>

#include "formats/database/response_database.h"

namespace palpate {

class OddCurve {
 public:
  explicit OddCurve(unsigned seed) : generator_(seed) {}

  [[nodiscard]] Measurement make() {
    constexpr int kSizes[] = {1, 2, 3, 8, 9, 12, 20, 40, 80, 150, 150, 300, 600};
    const int n = kSizes[pick(static_cast<int>(std::size(kSizes)))];
    Measurement m;
    way_ = pick(10);
    force_ = pick(10);
    level_ = chance();
    more_ = chance();
    for (int i = 0; i < n; ++i) {
      const double x = way(static_cast<double>(i) / std::max(1, n - 1));
      m.depth_m.push_back(x);
      m.force_n.push_back(force(x, i, n));
    }
    finish(m);
    return m;
  }

 private:
  int pick(int count) {
    return std::uniform_int_distribution<int>(0, count - 1)(generator_);
  }
  double chance() { return std::uniform_real_distribution<double>()(generator_); }
  double normal() { return std::normal_distribution<double>()(generator_); }

  // In 0 to 1, over the share t of the samples.
  double way(double t) {
    switch (way_) {
      case 0:
        return 1.0 - t;
      case 1:
        return level_ < 0.2 ? 0.3 : std::floor(8.0 * t) / 8.0;  // still, staircase
      case 2:
        return std::min(1.0, 1.6 * t);  // press and hold
      case 3:
        return 1.0 - std::abs(1.0 - 2.0 * t);  // press and release
      case 4:
        return std::abs(std::sin(2.0 * M_PI * t));  // two presses
      case 5:
        return level_ < 0.3 ? chance() : t + 0.02 * normal();
      case 6:
        return chance() < 0.5 ? 0.0 : 1.0;
      case 7:
        return std::floor((3.0 + 30.0 * level_) * t) / 30.0;  // each several times
      default:
        return t;
    }
  }

  double force(double x, int i, int n) {
    const double d = std::max(0.0, x - level_);
    switch (force_) {
      case 0:
        return more_ < 0.5 ? 0.0 : 1.0;
      case 1:
        return i == n / 2 ? 2.0 : 0.0;
      case 2:  // below the resolution, oftener to the end
        return chance() < (more_ < 0.5 ? 0.1 : 0.4 * i / n) ? 2.0 : 0.0;
      case 3:
        return std::floor(4.0 * x * (1.0 + more_)) +
               (more_ < 0.3 ? 0.1 * normal() : 0.0);
      case 4:
        return x < level_ ? 0.0 : 1.0;
      case 5:
        return std::round(20.0 * more_ * std::pow(d, 1.5) + 0.3 * normal());
      case 6:
        return std::sin(M_PI * (1.0 + 2.0 * more_) * x) + 3.0 * std::pow(d, 6.0) +
               0.01 * normal();
      case 7:
        return (x < level_ ? 10.0 * x : 10.0 * level_ * more_) + 0.02 * normal();
      case 8:
        return normal() * (more_ < 0.5 ? 1.0 : std::exp(3.0 * normal()));
      default:
        return std::pow(d, 1.0 + 3.0 * more_) + 0.003 * normal();
    }
  }

  void finish(Measurement& m) {
    constexpr double kSizes[] = {1e-3,  1.0,    1e-9,   1e-12, 1e6,
                                 1e-30, 1e-160, 1e-300, 1e150, 1e300};
    const int usual = pick(4) != 0 ? 2 : static_cast<int>(std::size(kSizes));
    const double depth = kSizes[pick(usual)], force = kSizes[pick(usual)];
    const double begin = pick(3) == 0 ? 1e3 * normal() : 0.0;
    const double zero = pick(6) == 0 ? 1e9 * normal() : 0.0;
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      m.depth_m[i] = depth * (m.depth_m[i] + begin);
      m.force_n[i] = (more_ < 0.2 ? -force : force) * (m.force_n[i] + zero);
    }
    for (int wild = pick(4) == 0 ? pick(3) : 0; wild > 0; --wild) {
      m.force_n[static_cast<std::size_t>(pick(static_cast<int>(m.force_n.size())))] =
          pick(6) == 0 ? std::numeric_limits<double>::quiet_NaN()
                       : 1e3 * force * normal();
    }
    if (pick(2) == 0) {
      add_times(m);
    }
  }

  void add_times(Measurement& m) {
    const int kind = pick(12);
    const auto n = static_cast<double>(m.depth_m.size());
    for (double i = 0.0; i < n; ++i) {
      switch (kind) {
        case 0:
          m.time_s.push_back(1.0);
          break;
        case 1:
          m.time_s.push_back(0.01 * (n - i));
          break;
        case 2:
          m.time_s.push_back(0.01 * i + (i > n / 2.0 ? 1e5 : 0.0));
          break;
        case 3:
          m.time_s.push_back(1e300 * chance());
          break;
        case 4:
          m.time_s.push_back(std::floor(0.1 * i));
          break;
        default:
          m.time_s.push_back(0.01 * i);
      }
    }
  }

  std::mt19937 generator_;
  int way_ = 0, force_ = 0;
  double level_ = 0.0, more_ = 0.0;
};

}  // namespace palpate
