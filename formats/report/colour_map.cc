#include "formats/report/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace palpate {
namespace {

// viridis at t = 0, 0.1, ... 1, in units of 1/255.
constexpr std::array<std::array<int, 3>, 11> kViridis = {{{68, 1, 84},
                                                          {72, 36, 117},
                                                          {65, 68, 135},
                                                          {53, 95, 141},
                                                          {42, 120, 142},
                                                          {33, 145, 140},
                                                          {34, 168, 132},
                                                          {68, 191, 112},
                                                          {122, 209, 81},
                                                          {189, 223, 38},
                                                          {253, 231, 37}}};

Colour anchor(std::size_t i) {
  return Colour(kViridis[i][0], kViridis[i][1], kViridis[i][2]) / 255.0;
}

}  // namespace

Colour viridis(double t) {
  constexpr double kLast = kViridis.size() - 1;
  const double at = t > 0.0 ? std::min(t, 1.0) * kLast : 0.0;
  const auto i = static_cast<std::size_t>(std::min(at, kLast - 1.0));
  const double part = at - static_cast<double>(i);
  return (1.0 - part) * anchor(i) + part * anchor(i + 1);
}

Colour lit(const Colour& colour, double light) {
  if (light <= 1.0) {
    return std::max(light, 0.0) * colour;
  }
  const double white = std::min(light - 1.0, 1.0);
  return (1.0 - white) * colour + white * Colour::Ones();
}

std::string hex(const Colour& colour) {
  const auto byte = [&](int i) {
    return static_cast<int>(std::lround(255.0 * std::clamp(colour[i], 0.0, 1.0)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2));
}

}  // namespace palpate
