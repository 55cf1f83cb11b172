// Presses and holds of a body whose relaxation is known: do the 95 % intervals of its
// terms hold, and do presses at different speeds tell the same?
//
// relaxation_study [RUNS [SEED]]   (default 100, 1)
// relaxation_study held FILE... [RUNS]   of measured holds: how far the joint fit is
// off, and whether the body that it finds, pressed again at the measured speed and ten
// times as fast, with noise as large as the residuals, tells the same terms (default
// 10)
//
// Every row is one case; runs differ by their noise, their contact point, and by up to
// a third in every time and by a fifth in every g. Terms are compared where as many
// were found as there are. "seen": the share of runs whose fastest term is slower than
// what the fit says that it sees; the columns after it are of those.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fitting/curve/time_effects.h"
#include "formats/measurement/measurement_file.h"

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
  double varied = 1.0;  // how much g and tau differ from run to run
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
    d.g[k] *= 1.0 + 0.2 * c.varied * even(generator);
    d.tau_s[k] *= 1.0 + 0.33 * c.varied * even(generator);
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

struct Agreement {
  double agreed = 0.0, compared = 0.0;  // pairs of g and of tau
  double other_terms = 0.0;             // runs that find not as many
};

Agreement agreement(const Case& slow, const Case& fast, int runs, unsigned seed) {
  Agreement all;
  for (int run = 0; run < runs; ++run) {
    std::mt19937 one(seed + static_cast<unsigned>(run)), other(one);
    const JointRelaxation a = find_relaxation(draw(slow, one).measurement).joint;
    const JointRelaxation b = find_relaxation(draw(fast, other).measurement).joint;
    if (a.terms.size() != b.terms.size()) {
      ++all.other_terms;
      continue;
    }
    for (std::size_t k = 0; k < a.terms.size(); ++k) {
      const RelaxationTerm &s = a.terms[k], &f = b.terms[k];
      all.compared += 2.0;
      all.agreed += std::abs(s.g - f.g) <= kZ * std::hypot(s.g_sd, f.g_sd) ? 1.0 : 0.0;
      all.agreed += std::abs(std::log(s.tau_s / f.tau_s)) <=
                            kZ * std::hypot(s.tau_sd_s / s.tau_s, f.tau_sd_s / f.tau_s)
                        ? 1.0
                        : 0.0;
    }
  }
  return all;
}

void print(const std::string& name, const Agreement& a) {
  fmt::print(
      "{}: {:.3f} of {:.0f} pairs of g and tau agree, {} runs find other terms\n", name,
      a.agreed / a.compared, a.compared, a.other_terms);
}

// The body that a measured press and hold tells, as a case.
Case case_of(const JointRelaxation& joint, const Relaxation& hold) {
  const auto curve = [joint](double u) {
    const auto& x = joint.displacement_m;
    const double at = x.front() + u * (x.back() - x.front());
    const auto above = std::upper_bound(x.begin(), x.end(), at);
    const auto i = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(above - x.begin() - 1, 0, std::ssize(x) - 2));
    const double share = (at - x[i]) / (x[i + 1] - x[i]);
    return std::lerp(joint.force_n[i], joint.force_n[i + 1], share) /
           joint.force_n.back();
  };
  Case c{"", curve, {}, {}, hold.speed_m_per_s, 10.0, hold.seconds, joint.rms_relative};
  c.varied = 0.0;
  for (const RelaxationTerm& term : joint.terms) {
    c.g.push_back(term.g);
    c.tau_s.push_back(term.tau_s);
  }
  return c;
}

void study_held(const std::vector<std::string>& files, int runs) {
  Agreement all;
  double worst = 0.0;
  for (const std::string& file : files) {
    const Relaxation hold =
        find_relaxation(read_measurement(file, {{"displacement", "mm"},
                                                {"force", "N"},
                                                MeasurementColumn{"time", "s"}})
                            .samples);
    if (!hold.joint.refused.empty()) {
      fmt::print("{}: {}\n", file, hold.joint.refused);
      continue;
    }
    worst = std::max(worst, hold.joint.rms_relative);
    const Case slow = case_of(hold.joint, hold);
    Case fast = slow;
    fast.speed_m_per_s *= 10.0;
    fast.rate_hz *= 10.0;
    const Agreement one = agreement(slow, fast, runs, 1);
    print(fmt::format("{}: off by {:.2f} %", file, 100.0 * hold.joint.rms_relative),
          one);
    all.agreed += one.agreed;
    all.compared += one.compared;
    all.other_terms += one.other_terms;
  }
  print(fmt::format("all, off by {:.2f} % at most", 100.0 * worst), all);
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
  for (const std::size_t k : {1U, 3U}) {
    print(cases[k].name + " and " + cases[k + 1].name,
          agreement(cases[k], cases[k + 1], runs, seed));
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    if (argc > 2 && std::string(argv[1]) == "held") {
      std::vector<std::string> files(argv + 2, argv + argc);
      const bool told =
          files.back().find_first_not_of("0123456789") == std::string::npos;
      const int runs = told ? std::stoi(files.back()) : 10;
      files.resize(files.size() - (told ? 1 : 0));
      palpate::study_held(files, runs);
      return EXIT_SUCCESS;
    }
    palpate::study(argc > 1 ? std::stoi(argv[1]) : 100,
                   argc > 2 ? static_cast<unsigned>(std::stoul(argv[2])) : 1U);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "relaxation_study: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
