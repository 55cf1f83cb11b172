// Bodies whose relaxation is known at every place, from presses with holds at scattered
// points, each fitted: where are fields taken, do their stated errors cover the truth,
// and how far off are field and median?
//
// relaxation_field_study [SEEDS [KIND [PROBES [REFINEMENTS [FIRST_SEED]]]]]   (default
// 4; all kinds, "" too; 20, 30 and 60; 3, each of which quarters the triangles; 1)
//
// Kinds: uniform; halves of two materials; smooth; weak, a fifth as much as smooth;
// patch, a place 4 cm wide that relaxes more; times, smooth with times that differ by a
// quarter too, so that no common times are right. Every run draws its own field.
//
// Of 95 % intervals, 1.96 times the stated error, at nodes of runs whose field was
// taken: "end" are shares at the end of the holds, "worst" the worst of all times up to
// it. Of all runs, "off" and "median": rms over the nodes of these shares by what was
// taken, and by the median. "out": coverage of measured shares at places left out.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fitting/surface/probe_relaxation.h"
#include "tests/support/held_press.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

using Truth = std::function<PronyTerms2(const Eigen::Vector3d&)>;
using Wave = std::function<double(const Eigen::Vector3d&)>;

constexpr double kHold = 10.0;
constexpr double kZ = 1.959964;

// A smooth random field in space, mean 0 and standard deviation 1.
Wave smooth_wave(std::mt19937& generator) {
  constexpr int kWaves = 200;
  constexpr double kLength = 0.05;
  std::normal_distribution<double> normal(0.0, 1.0 / kLength);
  std::uniform_real_distribution<double> phase(0.0, 6.283185307179586);
  std::vector<std::pair<Eigen::Vector3d, double>> wave;
  for (int i = 0; i < kWaves; ++i) {
    const Eigen::Vector3d k(normal(generator), normal(generator), normal(generator));
    wave.emplace_back(k, phase(generator));
  }
  return [wave](const Eigen::Vector3d& p) {
    double value = 0.0;
    for (const auto& [k, at] : wave) {
      value += std::sqrt(2.0 / kWaves) * std::sin(k.dot(p) + at);
    }
    return value;
  };
}

Truth truth_of(const std::string& kind, const SurfaceMesh& body,
               std::mt19937& generator) {
  const Wave a = smooth_wave(generator), b = smooth_wave(generator),
             c = smooth_wave(generator);
  std::uniform_int_distribution<Eigen::Index> pick(0, body.position_m.rows() - 1);
  const Eigen::Vector3d centre = body.position_m.row(pick(generator));
  const double part = kind == "weak"                        ? 0.2
                      : kind == "smooth" || kind == "times" ? 1.0
                                                            : 0.0;
  return [=](const Eigen::Vector3d& p) {
    PronyTerms2 terms = kPork;
    terms.g[0] = std::clamp(terms.g[0] + 0.07 * part * a(p), 0.02, 0.45);
    terms.g[1] = std::clamp(terms.g[1] + 0.10 * part * b(p), 0.02, 0.45);
    if (kind == "halves" && p.dot(centre) > 0.0) {
      terms.g = {0.15, 0.12};
    }
    if (kind == "patch" && (p - centre).norm() < 0.02) {
      terms.g = {0.40, 0.35};
    }
    if (kind == "times") {
      terms.tau_s[0] *= std::exp(0.25 * c(p));
      terms.tau_s[1] *= std::exp(0.25 * c(p));
    }
    return terms;
  };
}

Eigen::Vector3d random_place(const SurfaceMesh& body, std::mt19937& generator) {
  std::vector<double> area;
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    const Eigen::RowVector3d a = body.position_m.row(body.triangle(t, 0));
    const Eigen::RowVector3d b = body.position_m.row(body.triangle(t, 1));
    const Eigen::RowVector3d c = body.position_m.row(body.triangle(t, 2));
    area.push_back((b - a).cross(c - a).norm());
  }
  std::discrete_distribution<std::int32_t> triangle(area.begin(), area.end());
  std::uniform_real_distribution<double> uniform;
  const double u = std::sqrt(uniform(generator)), v = uniform(generator);
  return position_m(body, {triangle(generator), {1.0 - u, u * (1.0 - v), u * v}, 0.0});
}

std::vector<SurfaceProbe> probes_of(const SurfaceMesh& body, const Truth& truth,
                                    std::size_t count, std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(0.5, 2.0);
  std::vector<SurfaceProbe> probes(count);
  for (SurfaceProbe& probe : probes) {
    probe.position_m = random_place(body, generator);
    HeldPress press{truth(probe.position_m)};
    press.hold_s = kHold;
    press.noise_n *= uniform(generator);
    probe.relaxation = find_relaxation(measured(press, generator));
  }
  return probes;
}

double relaxed(const PronyTerms2& terms, double time_s) {
  return -terms.g[0] * std::expm1(-time_s / terms.tau_s[0]) -
         terms.g[1] * std::expm1(-time_s / terms.tau_s[1]);
}

struct Study {
  double runs = 0, taken = 0, end = 0, end2 = 0, worst = 0, out = 0, off = 0,
         median = 0, error = 0;
};

void study_once(const SurfaceMesh& body, const std::string& kind, std::size_t count,
                unsigned seed, Study& study) {
  std::mt19937 generator(seed);
  const Truth truth = truth_of(kind, body, generator);
  const std::vector<SurfaceProbe> probes = probes_of(body, truth, count, generator);
  std::vector<const SurfaceProbe*> all;
  for (const SurfaceProbe& probe : probes) {
    all.push_back(&probe);
  }
  const Viscoelasticity common = common_viscoelasticity(all);
  const auto [field, report] = relaxation_field(body, held_with_press(all), common);
  double end = 0.0, worst = 0.0, off = 0.0, by_median = 0.0;
  for (Eigen::Index i = 0; i < body.position_m.rows(); ++i) {
    const PronyTerms2 exact = truth(body.position_m.row(i));
    const auto miss = [&](const Viscoelasticity& by, double time_s) {
      return std::abs(1.0 - relaxed_share(by, i, time_s) - relaxed(exact, time_s));
    };
    const auto row = static_cast<std::size_t>(report.taken ? i : 0);
    const double most = kZ * static_cast<double>(field.error_relative[row]);
    bool within = true;
    for (double t = kHold; t > 0.01 * kHold; t *= 0.8) {
      within = within && miss(field, t) <= most;
    }
    end += miss(field, kHold) <= most ? 1.0 : 0.0;
    worst += within ? 1.0 : 0.0;
    off += std::pow(miss(field, kHold), 2);
    by_median += std::pow(miss(common, kHold), 2);
  }
  const auto n = static_cast<double>(body.position_m.rows());
  study.runs += 1.0;
  study.off += std::sqrt(off / n);
  study.median += std::sqrt(by_median / n);
  if (report.taken) {
    study.taken += 1.0;
    study.end += end / n;
    study.end2 += end * end / (n * n);
    study.worst += worst / n;
    study.out += report.coverage;
    study.error += report.error_median;
  }
}

// A mean over the runs that took the field; a dash where none did.
std::string of_taken(const Study& s, double sum, int digits) {
  return s.taken > 0.0 ? fmt::format("{:.{}f}", sum / s.taken, digits) : "-";
}

void print(const std::string& name, std::size_t count, const Study& s) {
  const double spread = s.end2 - s.end * s.end / s.taken;
  const std::string error =
      s.taken > 1.0
          ? fmt::format("{:.3f}",
                        std::sqrt(std::max(0.0, spread) / s.taken / (s.taken - 1.0)))
          : "-";
  fmt::print(
      "{:<20} {:>6} {:>5} {:>6.2f} {:>7} {:>6} {:>7} {:>8} {:>7} {:>7.4f} {:>7.4f}\n",
      name, count, s.runs, s.taken / s.runs, of_taken(s, s.end, 3), error,
      of_taken(s, s.worst, 3), of_taken(s, s.out, 3), of_taken(s, s.error, 4),
      s.off / s.runs, s.median / s.runs);
  std::fflush(stdout);
}

struct Plan {
  unsigned seeds = 4;
  std::string only = {};
  std::vector<std::size_t> counts{20, 30, 60};
  int refinements = 3;
  unsigned first_seed = 1;
};

void study_all(const Plan& plan) {
  const std::vector<SurfaceMesh> bodies = {
      sphere_surface(0.05, plan.refinements),
      stretched(sphere_surface(1.0, plan.refinements), {0.08, 0.05, 0.03}),
      organ_like(plan.refinements)};
  fmt::print("{:<20} {:>6} {:>5} {:>6} {:>7} {:>6} {:>7} {:>8} {:>7} {:>7} {:>7}\n",
             "kind", "probes", "runs", "taken", "end", "s.e.", "worst", "out", "stated",
             "off", "median");
  for (const std::string kind :
       {"uniform", "halves", "smooth", "weak", "patch", "times"}) {
    if (!plan.only.empty() && plan.only != kind) {
      continue;
    }
    for (const std::size_t count : plan.counts) {
      Study study;
      for (const SurfaceMesh& body : bodies) {
        for (unsigned k = 0; k < plan.seeds; ++k) {
          study_once(body, kind, count, plan.first_seed + k, study);
        }
      }
      print(kind, count, study);
    }
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    std::vector<std::string> words(argv + 1, argv + argc);
    words.resize(5);
    const auto number = [&](std::size_t i, unsigned otherwise) {
      return words[i].empty() ? otherwise : static_cast<unsigned>(std::stoul(words[i]));
    };
    palpate::Plan plan;
    plan.seeds = number(0, plan.seeds);
    plan.only = words[1];
    if (!words[2].empty()) {
      plan.counts = {number(2, 0)};
    }
    plan.refinements = static_cast<int>(number(3, 3));
    plan.first_seed = number(4, plan.first_seed);
    palpate::study_all(plan);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "relaxation_field_study: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
