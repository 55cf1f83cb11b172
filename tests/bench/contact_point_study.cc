// Contact point and modulus of synthetic curves: bias, spread, what the fit says of the
// spread, and how often its 95 % interval covers the truth where it tells one.
// Usage: contact_point_study [runs [first seed]]
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>

#include <fmt/format.h>

#include "fitting/curve/power_law_fit.h"
#include "fitting/material/moduli.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

struct Case {
  const char* name;
  SyntheticCurve curve;
  double misfit_n = 0.0;         // [N] of a wave over the depth that no law has
  double misfit_relative = 0.0;  // [-] of the force
  bool random = false;           // shapes of random size, not waves of one
};

constexpr double kNormal95 = 1.959964;
constexpr double kRadius = 5e-3, kPoisson = 0.45;  // of the sphere and the sample

// E of which a sphere's force at kSyntheticDepth is 1 N.
const double kYoung = 0.75 * (1.0 - kPoisson * kPoisson) / std::sqrt(kRadius) /
                      std::pow(kSyntheticDepth, 1.5);

// A shape over the depth in 1 of rms 1: one to two waves, their place by chance; or
// three harmonics of a period of 1.3 depths whose amplitudes are normal, so that a
// curve's may be none or twice as large.
std::function<double(double)> shape_of(const Case& c, unsigned seed) {
  std::mt19937 generator(seed);
  if (!c.random) {
    std::uniform_real_distribution<double> share;
    const double waves = 1.0 + share(generator), phase = 2.0 * M_PI * share(generator);
    return [=](double d) {
      return std::sin(2.0 * M_PI * waves * d + phase);
    };
  }
  std::normal_distribution<double> normal;
  std::array<double, 6> a{};
  for (double& amplitude : a) {
    amplitude = normal(generator) / std::sqrt(3.0);
  }
  return [a](double d) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = 2.0 * M_PI / 1.3 * static_cast<double>(k + 1) * d;
      sum += a[2 * k] * std::sin(angle) + a[2 * k + 1] * std::cos(angle);
    }
    return sum;
  };
}

void add_misfit(const Case& c, unsigned seed, Measurement& m) {
  const auto shape = shape_of(c, seed);
  for (std::size_t i = 0; i < m.force_n.size(); ++i) {
    const double d = (m.depth_m[i] - c.curve.free_m) / kSyntheticDepth;
    if (d > 0.0) {
      m.force_n[i] += c.misfit_n * (shape(d) - shape(0.0) * (1.0 - d)) +
                      c.misfit_relative * shape(d) * std::pow(d, c.curve.exponent);
    }
  }
}

// Errors, what was told of them, and how often the interval held the truth.
struct Coverage {
  double sum = 0.0, squares = 0.0, told = 0.0;
  unsigned covered = 0, with = 0;

  void add(double error, double sd) {
    if (std::isfinite(sd)) {
      sum += error;
      squares += error * error;
      told += sd;
      covered += std::abs(error) <= kNormal95 * sd ? 1 : 0;
      ++with;
    }
  }
  void print(double unit) const {
    const double n = with, mean = sum / n;
    fmt::print(" {:>+8.3f} {:>7.3f} {:>7.3f} {:>8.3f} {:>5}", unit * mean,
               unit * std::sqrt((squares - n * mean * mean) / (n - 1.0)),
               unit * told / n, covered / n, with);
  }
};

void report(const Case& c, unsigned runs, unsigned first_seed) {
  Indenter sphere{.shape = "sphere", .radius_m = kRadius, .poissons_ratio = kPoisson};
  Coverage contact, modulus;
  double seconds = 0.0;
  for (unsigned seed = first_seed; seed < first_seed + runs; ++seed) {
    Measurement m = synthetic(c.curve, 1000 + seed);
    add_misfit(c, seed, m);
    const Approach approach = select_approach(m);
    const ContactFit fit = fit_contact(approach);
    seconds += fit.seconds;
    if (!fit.has(FitFlag::kContactPointNotIdentified)) {
      contact.add(fit.contact.m - c.curve.free_m, fit.contact.sd_m);
    }
    if (c.curve.exponent == 1.5) {
      const Modulus found = find_modulus(approach, fit, sphere);
      modulus.add(found.youngs_modulus_pa - kYoung, found.sd_pa);
    }
  }
  fmt::print("{:<28}", c.name);
  contact.print(1e3);
  modulus.print(100.0 / kYoung);
  fmt::print(" {:>7.2f}\n", 1e3 * seconds / runs);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const auto runs = static_cast<unsigned>(argc > 1 ? std::atoi(argv[1]) : 400);
  const auto first_seed = static_cast<unsigned>(argc > 2 ? std::atoi(argv[2]) : 1);
  const palpate::Case cases[] = {
      {"p 1.5, noise 0.5 %", {}},
      {"noise 2 %", {.noise_n = 0.02}},
      {"drift 5 %", {.drift_n = 0.05}},
      {"p 2.5", {.exponent = 2.5}},
      {"0.3 mm of free travel", {.free_m = 0.3e-3}},
      {"neighbours alike by 0.5", {.rho = 0.5}},
      {"by 0.8", {.rho = 0.8}},
      {"by 0.95", {.rho = 0.95}},
      {"waves of 2 % of the force", {}, 0.0, 0.02},
      {"of 2 % of the largest", {}, 0.02},
      {"the same, noise 0.1 %", {.noise_n = 0.001}, 0.02},
      {"shapes of 2 % of the force", {}, 0.0, 0.02, true},
      {"of 2 % of the largest", {}, 0.02, 0.0, true},
      {"the same, noise 0.1 %", {.noise_n = 0.001}, 0.02, 0.0, true}};
  fmt::print("{:<28} {:^39} {:^39}\n", "", "contact point [mm]", "modulus [%]");
  const char* heads = " {:>8} {:>7} {:>7} {:>8} {:>5}";
  fmt::print("{:<28}", "case");
  for (int i = 0; i < 2; ++i) {
    fmt::print(fmt::runtime(heads), "bias", "sd", "told", "coverage", "of");
  }
  fmt::print(" {:>7}\n", "ms a fit");
  for (const auto& c : cases) {
    palpate::report(c, runs, first_seed);
  }
  return 0;
}
