// Presses and holds of a body whose relaxation is known: do the 95 % intervals of its
// terms hold, and do presses at different speeds tell the same?
//
// relaxation_study [RUNS [SEED]]   (default 100, 1)
//
// Every row is one case; runs differ by their noise, their contact point, and by up to
// a third in every time and by a fifth in every g. Terms are compared where as many
// were found as there are. "seen": the share of runs whose fastest term is slower than
// what the fit says that it sees; the columns after it are of those.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fitting/curve/time_effects.h"

namespace palpate {
namespace {

using Curve = std::function<double(double)>;  // force over the largest, by depth in 1

struct Case {
  std::string name;
  Curve curve;
  std::vector<double> g, tau_s;
  double speed_m_per_s = 1e-3;
  double rate_hz = 20.0;
  double hold_s = 20.0;
  double noise = 3e-3;  // [-] of the largest force
  double alike = 0.0;   // correlation of neighbouring noise
  bool release = false;
};

struct Drawn {
  std::vector<double> g, tau_s;
  Measurement measurement;
};

constexpr double kDepth = 5e-3;
constexpr int kSteps = 20;  // of the simulation to a sample
constexpr double kZ = 1.959964;

double position_m(const Case& c, double free_m, double t) {
  const double pressed = (kDepth + free_m) / c.speed_m_per_s;
  const double back = t - pressed - c.hold_s;
  return std::min(t, pressed) * c.speed_m_per_s - std::max(0.0, back) * c.speed_m_per_s;
}

Drawn draw(const Case& c, std::mt19937& generator) {
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  std::normal_distribution<double> normal;
  Drawn d{c.g, c.tau_s, {}};
  for (std::size_t k = 0; k < d.g.size(); ++k) {
    d.g[k] *= 1.0 + 0.2 * even(generator);
    d.tau_s[k] *= 1.0 + 0.33 * even(generator);
  }
  const double free_m = 6e-4 * (1.0 + 0.5 * even(generator));
  const double press_s = (kDepth + free_m) / c.speed_m_per_s;
  const double all_s = press_s + c.hold_s + (c.release ? 0.5 * press_s : 0.0);
  std::vector<double> q(c.g.size(), 0.0);
  const double h = 1.0 / (c.rate_hz * kSteps);
  double noise = normal(generator), before = 0.0;
  for (int i = 0; i * h <= all_s; ++i) {
    const double x = position_m(c, free_m, i * h);
    const double e = x > free_m ? c.curve((x - free_m) / kDepth) : 0.0;
    double force = e;
    for (std::size_t k = 0; k < q.size(); ++k) {
      q[k] += -std::expm1(-h / d.tau_s[k]) * (0.5 * (before + e) - q[k]);
      force -= d.g[k] * q[k];
    }
    before = e;
    if (i % kSteps == 0) {
      d.measurement.time_s.push_back(i * h);
      d.measurement.depth_m.push_back(x);
      d.measurement.force_n.push_back(force + c.noise * noise);
      noise = c.alike * noise + std::sqrt(1.0 - c.alike * c.alike) * normal(generator);
    }
  }
  return d;
}

struct Score {
  double runs = 0, fitted = 0, seen = 0, right = 0, g = 0, tau = 0, terms = 0, rest = 0,
         curve = 0;
};

void count(const Case& c, const Drawn& d, Score& score) {
  const JointRelaxation joint = find_relaxation(d.measurement).joint;
  ++score.runs;
  if (!joint.refused.empty()) {
    return;
  }
  ++score.fitted;
  if (d.tau_s.front() < joint.seen_from_s) {
    return;
  }
  ++score.seen;
  double rest = 1.0;
  for (const double g : d.g) {
    rest -= g;
  }
  score.rest += std::abs(joint.g_inf - rest) <= kZ * joint.g_inf_sd ? 1.0 : 0.0;
  score.curve +=
      std::abs(joint.force_n.back() - c.curve(1.0)) <= kZ * joint.force_sd_n.back()
          ? 1.0
          : 0.0;
  if (joint.terms.size() != d.g.size()) {
    return;
  }
  ++score.right;
  for (std::size_t k = 0; k < d.g.size(); ++k) {
    const RelaxationTerm& term = joint.terms[k];
    ++score.terms;
    score.g += std::abs(term.g - d.g[k]) <= kZ * term.g_sd ? 1.0 : 0.0;
    score.tau +=
        std::abs(std::log(term.tau_s / d.tau_s[k])) <= kZ * term.tau_sd_s / term.tau_s
            ? 1.0
            : 0.0;
  }
}

double agreement(const Case& slow, const Case& fast, int runs, unsigned seed) {
  double agreed = 0.0, compared = 0.0;
  for (int run = 0; run < runs; ++run) {
    std::mt19937 one(seed + static_cast<unsigned>(run)), other(one);
    const JointRelaxation a = find_relaxation(draw(slow, one).measurement).joint;
    const JointRelaxation b = find_relaxation(draw(fast, other).measurement).joint;
    if (a.terms.size() != b.terms.size()) {
      continue;
    }
    for (std::size_t k = 0; k < a.terms.size(); ++k) {
      const RelaxationTerm &s = a.terms[k], &f = b.terms[k];
      compared += 2.0;
      agreed += std::abs(s.g - f.g) <= kZ * std::hypot(s.g_sd, f.g_sd) ? 1.0 : 0.0;
      agreed += std::abs(std::log(s.tau_s / f.tau_s)) <=
                        kZ * std::hypot(s.tau_sd_s / s.tau_s, f.tau_sd_s / f.tau_s)
                    ? 1.0
                    : 0.0;
    }
  }
  fmt::print("{} and {}: {:.3f} of {:.0f} pairs of g and tau agree\n", slow.name,
             fast.name, agreed / compared, compared);
  return agreed / compared;
}

void study(int runs, unsigned seed) {
  const Curve hertz = [](double u) {
    return std::pow(u, 1.5);
  };
  const Curve stiffening = [](double u) {
    return 0.3 * u + 0.7 * std::expm1(4.0 * u) / std::expm1(4.0);
  };
  const Curve softening = [](double u) {
    return std::tanh(1.5 * u) / std::tanh(1.5);
  };
  const Curve toe = [](double u) {
    return u < 0.5 ? 0.5 * u * u
                   : 0.125 + 0.5 * (u - 0.5) + 2.5 * (u - 0.5) * (u - 0.5);
  };
  const std::vector<double> g2{0.258, 0.303}, tau2{0.42, 4.5};
  const std::vector<Case> cases = {
      {"sphere, 1 mm/s", hertz, g2, tau2},
      {"sphere, 0.5 mm/s", hertz, g2, tau2, 5e-4},
      {"sphere, 50 mm/s", hertz, g2, tau2, 5e-2, 500.0},
      {"stiffening, 0.5 mm/s", stiffening, g2, tau2, 5e-4},
      {"stiffening, 5 mm/s", stiffening, g2, tau2, 5e-3, 50.0},
      {"softening, 0.5 mm/s", softening, g2, tau2, 5e-4},
      {"two parabolas, 2 mm/s", toe, g2, tau2, 2e-3, 50.0},
      {"one term", hertz, {0.4}, {1.5}, 2e-3},
      {"three terms", hertz, {0.2, 0.2, 0.2}, {0.2, 1.5, 9.0}, 5e-3, 50.0, 30.0, 1e-3},
      {"noise 1 %", hertz, g2, tau2, 1e-3, 20.0, 20.0, 1e-2},
      {"noise alike by 0.8", hertz, g2, tau2, 1e-3, 20.0, 20.0, 3e-3, 0.8},
      {"with release", hertz, g2, tau2, 1e-3, 20.0, 20.0, 3e-3, 0.0, true}};
  fmt::print("{:<24} {:>6} {:>6} {:>7} {:>7} {:>8} {:>8} {:>8}\n", "case", "fitted",
             "seen", "terms", "g", "tau", "g_inf", "curve");
  for (const Case& c : cases) {
    Score s;
    std::mt19937 generator(seed);
    for (int run = 0; run < runs; ++run) {
      count(c, draw(c, generator), s);
    }
    fmt::print(
        "{:<24} {:>6.3f} {:>6.3f} {:>7.3f} {:>7.3f} {:>8.3f} {:>8.3f} {:>8.3f}\n",
        c.name, s.fitted / s.runs, s.seen / s.fitted, s.right / s.seen, s.g / s.terms,
        s.tau / s.terms, s.rest / s.seen, s.curve / s.seen);
    std::fflush(stdout);
  }
  (void)agreement(cases[1], cases[2], runs, seed);
  (void)agreement(cases[3], cases[4], runs, seed);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::study(argc > 1 ? std::stoi(argv[1]) : 100,
                   argc > 2 ? static_cast<unsigned>(std::stoul(argv[2])) : 1U);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "relaxation_study: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
