// Which family is chosen of curves with a plateau, a knee or a fall, and how well it
// follows them. Usage:
// family_study [runs [samples [first seed]]]
#include <cmath>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

#include "fitting/curve/fit_rating.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

struct Shape {
  const char* name;
  double (*force)(double d, double at);  // both [-] of the depth
};

constexpr Shape kShapes[] = {
    {"power law",
     [](double d, double) {
       return std::pow(d, 1.5);
     }},
    {"plateau",
     [](double d, double at) {
       return std::min(std::pow(d / at, 1.5), 1.0);
     }},
    {"plateau, then on",
     [](double d, double at) {
       const double rest = std::max(0.0, d - at - 0.25);
       return std::min(std::pow(d / at, 1.5), 1.0) + 3.0 * rest * rest;
     }},
    {"knee",
     [](double d, double at) {
       return d < at ? d : at + 0.25 * (d - at);
     }},
    {"knee of a power law",
     [](double d, double at) {
       return d < at ? std::pow(d, 1.5)
                     : std::pow(at, 1.5) + 0.45 * std::sqrt(at) * (d - at);
     }},
    {"fall",
     [](double d, double at) {
       return d < at
                  ? std::pow(d, 1.5)
                  : std::pow(at, 1.5) * (d < at + 0.05 ? 1.0 - 6.0 * (d - at) : 0.7) +
                        (d < at + 0.05 ? 0.0 : std::pow(d - at - 0.05, 1.5));
     }},
};

const std::vector<std::string> kAll(kFamilyNames.begin(), kFamilyNames.end());

double rms_to_truth(const FamilyFit& fit, const Shape& shape, double at, double scale) {
  double squares = 0.0;
  constexpr int kPoints = 1000;
  for (int i = 0; i < kPoints; ++i) {
    const double d = (i + 0.5) / kPoints;
    const double error =
        fitted_force_n(fit, 2e-3 + kSyntheticDepth * d) - scale * shape.force(d, at);
    squares += error * error;
  }
  return std::sqrt(squares / kPoints);
}

void report(const Shape& shape, double rho, double noise_n, unsigned runs, int samples,
            unsigned first_seed) {
  unsigned follows = 0, flagged = 0, used_and_missed = 0;
  double told = 0.0, worst = 0.0, seen = 0.0;
  std::map<std::string, int> chosen;
  for (unsigned seed = first_seed; seed < first_seed + runs; ++seed) {
    const double at = 0.3 + 0.4 * ((seed * 37) % 100) / 100.0;
    Measurement m =
        synthetic({.noise_n = noise_n, .rho = rho, .samples = samples}, 100 + seed);
    double most = 0.0;
    for (int i = 0; i <= 100; ++i) {
      most = std::max(most, shape.force(0.01 * i, at));
    }
    for (std::size_t i = 0; i < m.force_n.size(); ++i) {
      const double d = std::max(0.0, m.depth_m[i] - 2e-3) / kSyntheticDepth;
      m.force_n[i] += shape.force(d, at) / most - std::pow(d, 1.5);
    }
    const Approach approach = select_approach(m);
    const ContactFit contact = fit_contact(approach);
    const FamilyChoice choice =
        fit_families(approach, contact, kAll, "aicc", {.cross_validate = false});
    const Rating rating = rate(contact, choice);
    const FamilyFit& best = choice.fits.front();
    const double off = rms_to_truth(best, shape, at, 1.0 / most);
    worst = std::max(worst, off / noise_n);
    follows += best.rms_n <= 1.5 * noise_n ? 1 : 0;
    used_and_missed += rating.verdict == Verdict::kUse && off > 1.5 * noise_n ? 1 : 0;
    flagged += best.misses ? 1 : 0;
    seen += choice.features.empty() ? 0.0 : 1.0;
    told += choice.noise_sd_n / noise_n;
    ++chosen[best.family];
  }
  std::string names;
  for (const auto& [name, count] : chosen) {
    names += fmt::format("{} {}  ", name, count);
  }
  const double n = runs;
  fmt::print(
      "{:<20} {:>4} {:>6} {:>8.3f} {:>7.3f} {:>7.3f} {:>7.2f} {:>7.2f} {:>7.2f}  {}\n",
      shape.name, rho, noise_n, follows / n, flagged / n, used_and_missed / n, seen / n,
      told / n, worst, names);
  std::fflush(stdout);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const auto runs = static_cast<unsigned>(argc > 1 ? std::atoi(argv[1]) : 200);
  const int samples = argc > 2 ? std::atoi(argv[2]) : 500;
  const auto first_seed = static_cast<unsigned>(argc > 3 ? std::atoi(argv[3]) : 1);
  fmt::print("{:<20} {:>4} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7}\n", "shape", "rho",
             "noise", "follows", "misfit", "misused", "seen", "told", "worst");
  for (const auto& shape : palpate::kShapes) {
    for (const double rho : {0.0, 0.8}) {
      for (const double noise_n : {0.002, 0.01}) {
        palpate::report(shape, rho, noise_n, runs, samples, first_seed);
      }
    }
  }
  return 0;
}
