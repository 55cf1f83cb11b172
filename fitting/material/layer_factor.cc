// Exact values of contact with a bonded elastic layer, and their interpolation.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "fitting/material/moduli.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

// Flat punch: F = 2 E* a d kappa; rows a/h, columns Poisson's ratio.
constexpr double kPunchNu[] = {0.30, 0.35, 0.40, 0.45, 0.50};
constexpr double kPunchRatio[] = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0};
constexpr double kPunch[8][5] = {
    {1.0, 1.0, 1.0, 1.0, 1.0},           {1.207, 1.218, 1.232, 1.252, 1.281},
    {1.473, 1.502, 1.542, 1.599, 1.684}, {1.785, 1.840, 1.918, 2.033, 2.213},
    {2.126, 2.213, 2.340, 2.535, 2.860}, {2.484, 2.608, 2.794, 3.091, 3.619},
    {3.409, 3.640, 4.010, 4.658, 6.003}, {4.353, 4.706, 5.299, 6.421, 9.149}};

// Paraboloid: kappa_s = 3 F (1 - nu) / (8 G a d), chi_s = d R / a^2; rows a/h.
constexpr double kSphereNu[] = {0.30, 0.45, 0.50};
constexpr double kSphereRatio[] = {0.0, 0.2, 0.6, 1.0, 2.0};
constexpr double kSphereForce[5][3] = {{1.0, 1.0, 1.0},
                                       {1.131, 1.159, 1.175},
                                       {1.486, 1.619, 1.709},
                                       {1.944, 2.272, 2.521},
                                       {3.279, 4.464, 5.711}};
constexpr double kSphereDepth[5][3] = {{1.0, 1.0, 1.0},
                                       {0.8876, 0.8678, 0.8563},
                                       {0.7281, 0.6849, 0.6586},
                                       {0.6476, 0.5947, 0.5594},
                                       {0.5730, 0.5099, 0.4549}};
// The same for nu = 0.5 on a finer grid: F over Hertz's by sqrt(R d) / h.
constexpr double kHalfChi[] = {0.0, 0.0491, 0.0962, 0.1851, 0.3444, 0.4869, 0.7479};
constexpr double kHalfFactor[] = {1.0, 1.0590, 1.1235, 1.2698, 1.6355, 2.1056, 3.3711};

// Lagrange's parabola through the three nodes around x: the tables are smooth.
double interpolate(std::span<const double> x, std::span<const double> y, double at) {
  const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, at);
  auto first = static_cast<std::size_t>(above - x.begin()) - 1;
  if (first + 3 > x.size()) {
    first = x.size() - 3;
  } else if (first > 0 && at - x[first] < x[first + 1] - at) {
    --first;
  }
  double sum = 0.0;
  for (std::size_t i = first; i < first + 3; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < first + 3; ++j) {
      weight *= i == j ? 1.0 : (at - x[j]) / (x[i] - x[j]);
    }
    sum += weight * y[i];
  }
  return sum;
}

void check_ratio(double poissons_ratio) {
  if (!(poissons_ratio >= 0.3 && poissons_ratio <= 0.5)) {
    throw InputError(
        fmt::format("Poisson's ratio {} on a layer: the exact values cover [0.3, 0.5]",
                    poissons_ratio));
  }
}

}  // namespace

double punch_layer_factor(double radius_over_thickness, double poissons_ratio) {
  check_ratio(poissons_ratio);
  if (!(radius_over_thickness >= 0.0 && radius_over_thickness <= 2.0)) {
    throw InputError(
        fmt::format("punch radius over layer thickness is {}, the exact values cover "
                    "[0, 2]",
                    radius_over_thickness));
  }
  std::vector<double> column;
  for (const auto& row : kPunch) {
    column.push_back(interpolate(kPunchNu, row, poissons_ratio));
  }
  return interpolate(kPunchRatio, column, radius_over_thickness);
}

double sphere_layer_factor(double chi, double poissons_ratio) {
  check_ratio(poissons_ratio);
  // F / F_Hertz = kappa_s a / sqrt(R d), and sqrt(R d) / h = (a / h) sqrt(chi_s).
  std::vector<double> at{0.0}, factor{1.0};
  for (std::size_t i = 1; i < std::size(kSphereRatio); ++i) {
    const double root =
        std::sqrt(interpolate(kSphereNu, kSphereDepth[i], poissons_ratio));
    at.push_back(kSphereRatio[i] * root);
    factor.push_back(interpolate(kSphereNu, kSphereForce[i], poissons_ratio) / root);
  }
  if (!(chi >= 0.0 && chi <= at.back())) {
    throw InputError(
        fmt::format("sqrt(R d) over layer thickness is {:.3g}, the exact values cover "
                    "[0, {:.3g}]",
                    chi, at.back()));
  }
  if (poissons_ratio == 0.5 && chi <= kHalfChi[6]) {
    return interpolate(kHalfChi, kHalfFactor, chi);
  }
  return interpolate(at, factor, chi);
}

}  // namespace palpate
