#include "runtime/hand/hand_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace palpate {
namespace {

// From 0 to 1 for t in [0, 1], at rest with no acceleration at both ends, and its
// slope.
struct Blend {
  double value;
  double slope;
};

Blend blend(double t) noexcept {
  const double rest = 1.0 - t;
  return {t * t * t * (10.0 + t * (6.0 * t - 15.0)), 30.0 * t * t * rest * rest};
}

}  // namespace

HandTarget HandScript::at(double time_s) const noexcept {
  // Height above touch at the end of each part; the circle is the fourth.
  struct Part {
    double share;
    double height_m;
  };
  const std::array<Part, 8> parts = {{{0.05, clear_m},
                                      {0.15, 0.0},
                                      {0.10, -press_m},
                                      {0.35, -press_m},
                                      {0.10, -deeper_m},
                                      {0.05, -deeper_m},
                                      {0.15, clear_m},
                                      {0.05, clear_m}}};
  constexpr std::size_t kCircle = 3;

  double t = std::fmod(std::max(0.0, time_s - still_s), duration_s) / duration_s;
  double from_m = clear_m;
  std::size_t i = 0;
  while (i + 1 < parts.size() && t >= parts[i].share) {
    t -= parts[i].share;
    from_m = parts[i].height_m;
    ++i;
  }
  const Blend b = blend(t / parts[i].share);
  const double rate = b.slope / (parts[i].share * duration_s);
  const double rise_m = parts[i].height_m - from_m;

  HandTarget target;
  target.position_m = surface_m + (touch_m + from_m + b.value * rise_m) * normal;
  target.velocity_m_per_s = rate * rise_m * normal;
  if (i == kCircle) {
    // A circle through the pressed point: (1 - cos, sin) leaves and returns to it.
    const Eigen::Vector3d e1 = normal.unitOrthogonal();
    const Eigen::Vector3d e2 = normal.cross(e1);
    const double turn = 2.0 * std::numbers::pi;
    const double angle = turn * b.value;
    target.position_m +=
        circle_m * ((1.0 - std::cos(angle)) * e1 + std::sin(angle) * e2);
    target.velocity_m_per_s +=
        circle_m * turn * rate * (std::sin(angle) * e1 + std::cos(angle) * e2);
  }
  return target;
}

}  // namespace palpate
