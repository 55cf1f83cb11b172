// Contact point of synthetic curves: bias, spread, what the fit says of the spread, and
// how often its 95 % interval covers the truth. Usage: contact_point_study [runs]
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "fitting/curve/power_law_fit.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

struct Case {
  const char* name;
  SyntheticCurve curve;
};

constexpr double kNormal95 = 1.959964;

void report(const Case& c, unsigned runs) {
  double sum = 0.0, squares = 0.0, told = 0.0, seconds = 0.0;
  unsigned covered = 0, without = 0;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const ContactFit fit =
        fit_contact(select_approach(synthetic(c.curve, 1000 + seed)));
    const double error = fit.contact_point_m - c.curve.free_m;
    sum += error;
    squares += error * error;
    seconds += fit.seconds;
    if (std::isfinite(fit.contact_point_sd_m)) {
      told += fit.contact_point_sd_m;
      covered += std::abs(error) <= kNormal95 * fit.contact_point_sd_m ? 1 : 0;
    } else {
      ++without;
    }
  }
  const double n = runs, with = n - without, mean = sum / n;
  const double sd = std::sqrt((squares - n * mean * mean) / (n - 1.0));
  fmt::print("{:<28} {:>+9.4f} {:>8.4f} {:>8.4f} {:>8.3f} {:>8} {:>9.2f}\n", c.name,
             1e3 * mean, 1e3 * sd, 1e3 * told / with, covered / with, without,
             1e3 * seconds / n);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const auto runs = static_cast<unsigned>(argc > 1 ? std::atoi(argv[1]) : 400);
  const palpate::Case cases[] = {{"p 1.5, noise 0.5 %", {}},
                                 {"noise 2 %", {.noise_n = 0.02}},
                                 {"drift 5 %", {.drift_n = 0.05}},
                                 {"p 2.5", {.exponent = 2.5}},
                                 {"0.3 mm of free travel", {.free_m = 0.3e-3}},
                                 {"neighbours alike by 0.5", {.rho = 0.5}},
                                 {"by 0.8", {.rho = 0.8}},
                                 {"by 0.95", {.rho = 0.95}}};
  fmt::print("{:<28} {:>9} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "errors in mm", "bias",
             "sd", "told sd", "coverage", "none", "ms a fit");
  for (const auto& c : cases) {
    palpate::report(c, runs);
  }
  return 0;
}
