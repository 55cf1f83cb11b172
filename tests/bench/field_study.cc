// Surface fields of known bodies from scattered probes: do the error bars cover the
// truth, what is gained over nearest neighbour and inverse distance, are bad probes
// found?
//
// field_study [SEEDS [KIND [REFINEMENTS [FIRST_SEED]]]]   (default 3; all of smooth,
// inclusion, rough; 4, each of which quarters the triangles; 1)
// field_study patches [SEEDS [KIND [REFINEMENTS [FIRST_SEED]]]]   without spoilt
// probes: also how whole patches of neighbouring probes are predicted by the others,
// with everything done again without them
//
// Errors of neighbours go together, so that a single run covers anything from 0.85 to
// 1: the coverage's standard error over the runs says what a mean is worth.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fitting/surface/field_patches.h"
#include "fitting/surface/probe_screen.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

using Truth = std::function<double(const Eigen::Vector3d&)>;  // log force at 5 mm

struct Body {
  std::string name;
  SurfaceMesh mesh;
};

struct Study {
  double node_coverage = 0.0;  // of the truth by 95 % intervals at the nodes
  double left_out_coverage = 0.0;
  double patch_coverage = 0.0;  // NaN: not asked for
  double rms = 0.0;             // of log force at the nodes
  double nearest = 0.0;
  double inverse_distance = 0.0;
  int found = 0;  // of five glitched probes
  int false_alarms = 0;
  double seconds = 0.0;
};

constexpr std::size_t kGlitches = 5;
constexpr double kNoiseMin = 0.02;  // of log force; stated per probe, up to twice that

// Matern fields in space (waves whose vectors have its spectrum, a multivariate t
// distribution with 2 nu degrees of freedom), and a stiff inclusion with an edge of
// 4 mm. None is the model's own: that lives on the surface, has other smoothnesses, and
// knows no edges.
struct Kind {
  std::string name;
  double smoothness = 2.5;
  double length_m = 0.05;
  bool inclusion = false;
};

Truth truth_of(std::mt19937& generator, const Body& body, const Kind& kind) {
  constexpr int kWaves = 300;
  const double freedom = 2.0 * kind.smoothness;
  std::normal_distribution<double> normal;
  std::chi_squared_distribution<double> chi2(freedom);
  std::uniform_real_distribution<double> phase(0.0, 6.283185307179586);
  std::vector<std::pair<Eigen::Vector3d, double>> wave;
  for (int i = 0; i < kWaves; ++i) {
    const Eigen::Vector3d k(normal(generator), normal(generator), normal(generator));
    wave.emplace_back(k / kind.length_m * std::sqrt(freedom / chi2(generator)),
                      phase(generator));
  }
  std::uniform_int_distribution<Eigen::Index> pick(0, body.mesh.position_m.rows() - 1);
  const Eigen::Vector3d centre = body.mesh.position_m.row(pick(generator));
  return [=](const Eigen::Vector3d& p) {
    double value = 0.0;
    for (const auto& [k, at] : wave) {
      value += std::sin(k.dot(p) + at);
    }
    value *= 0.5 * std::sqrt(2.0 / kWaves);
    const double out = ((p - centre).norm() - 0.015) / 0.004;
    return value + (kind.inclusion ? 0.8 / (1.0 + std::exp(out)) : 0.0);
  };
}

struct Probes {
  std::vector<AttachedPoint> point;
  FieldData data;
  std::vector<std::size_t> glitched;
};

Probes probe(const Body& body, const Truth& truth, std::size_t count,
             std::size_t glitches, std::mt19937& generator) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<double> area;
  for (Eigen::Index t = 0; t < body.mesh.triangle.rows(); ++t) {
    const Eigen::RowVector3d a = body.mesh.position_m.row(body.mesh.triangle(t, 0));
    const Eigen::RowVector3d b = body.mesh.position_m.row(body.mesh.triangle(t, 1));
    const Eigen::RowVector3d c = body.mesh.position_m.row(body.mesh.triangle(t, 2));
    area.push_back((b - a).cross(c - a).norm());
  }
  std::discrete_distribution<std::int32_t> triangle(area.begin(), area.end());
  Probes probes;
  const auto m = static_cast<Eigen::Index>(count);
  probes.data = {Eigen::VectorXd(m), Eigen::VectorXd(m), std::vector<char>(count, 1)};
  for (Eigen::Index i = 0; i < m; ++i) {
    const double u = std::sqrt(uniform(generator));
    const double v = uniform(generator);
    probes.point.push_back({triangle(generator), {1.0 - u, u * (1.0 - v), u * v}, 0.0});
    probes.data.sd[i] = kNoiseMin * (1.0 + uniform(generator));
    probes.data.value[i] = truth(position_m(body.mesh, probes.point.back())) +
                           probes.data.sd[i] * normal(generator);
  }
  std::uniform_int_distribution<std::size_t> pick(0, count - 1);
  while (probes.glitched.size() < glitches) {
    const std::size_t i = pick(generator);
    if (std::find(probes.glitched.begin(), probes.glitched.end(), i) ==
        probes.glitched.end()) {
      probes.data.value[static_cast<Eigen::Index>(i)] +=
          (i % 2 == 0 ? 1.0 : -1.0) * std::log(4.0);
      probes.glitched.push_back(i);
    }
  }
  return probes;
}

// Rms errors at the nodes of what people use else; both without the glitched probes,
// which they could not have found.
void rivals(const Body& body, const Probes& probes, const Eigen::VectorXd& truth,
            Study& study) {
  double nearest = 0.0;
  double inverse = 0.0;
  for (Eigen::Index n = 0; n < truth.size(); ++n) {
    double closest = 1e300;
    double at_closest = 0.0;
    double weights = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < probes.point.size(); ++i) {
      if (std::find(probes.glitched.begin(), probes.glitched.end(), i) !=
          probes.glitched.end()) {
        continue;
      }
      const double value = probes.data.value[static_cast<Eigen::Index>(i)];
      const double d2 = (position_m(body.mesh, probes.point[i]) -
                         body.mesh.position_m.row(n).transpose())
                            .squaredNorm();
      if (d2 < closest) {
        closest = d2;
        at_closest = value;
      }
      weights += 1.0 / (d2 * d2 + 1e-20);  // power 4: the best of 2, 3, 4 here
      sum += value / (d2 * d2 + 1e-20);
    }
    nearest += (at_closest - truth[n]) * (at_closest - truth[n]);
    inverse += (sum / weights - truth[n]) * (sum / weights - truth[n]);
  }
  study.nearest = std::sqrt(nearest / static_cast<double>(truth.size()));
  study.inverse_distance = std::sqrt(inverse / static_cast<double>(truth.size()));
}

double share_covered(const Eigen::VectorXd& residual, const Eigen::VectorXd& sd,
                     const std::vector<char>& counts) {
  double covered = 0.0;
  double all = 0.0;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    if (counts.empty() || counts[static_cast<std::size_t>(i)] != 0) {
      covered += std::abs(residual[i]) <= 1.959964 * sd[i] ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  return covered / all;
}

Study study_once(const Body& body, std::size_t count, const Kind& kind, unsigned seed,
                 bool patches) {
  std::mt19937 generator(seed);
  const Truth truth = truth_of(generator, body, kind);
  const Probes probes = probe(body, truth, count, patches ? 0 : kGlitches, generator);
  const FieldModel model(body.mesh, probes.point);
  const FieldData data[] = {probes.data};
  const ScreenedField screened = screen_probes(model, data);
  const FieldPosterior posterior = mixed_posterior(
      model, probable_parameters(model, screened.data, screened.parameters),
      screened.data[0]);
  Eigen::VectorXd exact(body.mesh.position_m.rows());
  for (Eigen::Index i = 0; i < exact.size(); ++i) {
    exact[i] = truth(body.mesh.position_m.row(i));
  }
  Study study;
  study.node_coverage = share_covered(posterior.at_nodes() - exact, posterior.sd, {});
  study.left_out_coverage = share_covered(posterior.left_out_residual,
                                          posterior.left_out_sd, screened.data[0].used);
  study.rms = std::sqrt((posterior.at_nodes() - exact).squaredNorm() /
                        static_cast<double>(exact.size()));
  rivals(body, probes, exact, study);
  for (const BadProbe& bad : screened.bad) {
    const bool glitched = std::find(probes.glitched.begin(), probes.glitched.end(),
                                    bad.point) != probes.glitched.end();
    (glitched ? study.found : study.false_alarms) += 1;
  }
  study.seconds = screened.parameters.seconds;
  study.patch_coverage =
      patches ? left_out_patches(model, data, screened.parameters.parameters).coverage
              : std::nan("");
  return study;
}

void print_mean(const std::string& name, std::size_t count,
                const std::vector<Study>& runs) {
  const auto mean = [&](auto member) {
    double sum = 0.0;
    for (const Study& run : runs) {
      sum += static_cast<double>(run.*member);
    }
    return sum / static_cast<double>(runs.size());
  };
  const double rms = mean(&Study::rms);
  const auto n = static_cast<double>(runs.size());
  const auto error = [&](auto member) {
    double squares = 0.0;
    for (const Study& run : runs) {
      squares += std::pow(run.*member - mean(member), 2);
    }
    return n > 1.0 ? std::sqrt(squares / (n - 1.0) / n) : 0.0;
  };
  fmt::print(
      "{:<22} {:>6} {:>9.3f} {:>6.3f} {:>9.3f} {:>9.3f} {:>6.3f} {:>8.4f} {:>8.4f} "
      "{:>8.4f} "
      "{:>6.1f} "
      "{:>6.1f} "
      "{:>7.1f} {:>6.1f} {:>7.2f}\n",
      name, count, mean(&Study::node_coverage), error(&Study::node_coverage),
      mean(&Study::left_out_coverage), mean(&Study::patch_coverage),
      error(&Study::patch_coverage), rms, mean(&Study::nearest),
      mean(&Study::inverse_distance), mean(&Study::nearest) / rms,
      mean(&Study::inverse_distance) / rms, mean(&Study::found),
      mean(&Study::false_alarms), mean(&Study::seconds));
  std::fflush(stdout);
}

struct Plan {
  unsigned seeds = 3;
  std::string only = {};
  int refinements = 4;
  unsigned first_seed = 1;
  bool patches = false;
  unsigned probes = 0;  // 0: three numbers
};

void study_all(const Plan& plan) {
  const auto [seeds, only, refinements, first_seed, patches, probes] = plan;
  std::vector<std::size_t> counts{100, 250, 600};
  if (patches) {
    counts = {30, 100, 300};
  }
  if (probes > 0) {
    counts = {probes};
  }
  const Body bodies[] = {
      {"sphere", sphere_surface(0.05, refinements)},
      {"ellipsoid", stretched(sphere_surface(1.0, refinements), {0.08, 0.05, 0.03})},
      {"organ", organ_like(refinements)}};
  fmt::print(
      "means of {} runs each; rms of log force at the nodes; coverage of 95 % "
      "intervals\n{:<22} {:>6} {:>9} {:>6} {:>9} {:>9} {:>6} {:>8} {:>8} {:>8} {:>6} "
      "{:>6} "
      "{:>7} {:>6} {:>7}\n",
      seeds, "body", "probes", "at nodes", "s.e.", "left out", "patches", "s.e.", "rms",
      "nearest", "inv.d.", "gain", "gain", "found/5", "false", "fit [s]");
  std::vector<Study> all;
  const Kind kinds[] = {{"smooth", 2.5, 0.05, false},
                        {"inclusion", 2.5, 0.05, true},
                        {"rough", 1.5, 0.04, false}};
  for (const Body& body : bodies) {
    for (const Kind& kind : kinds) {
      if (!only.empty() && only != kind.name) {
        continue;
      }
      for (const std::size_t count : counts) {
        std::vector<Study> runs;
        for (unsigned k = 0; k < seeds; ++k) {
          runs.push_back(study_once(body, count, kind, first_seed + k, patches));
        }
        print_mean(body.name + ", " + kind.name, count, runs);
        all.insert(all.end(), runs.begin(), runs.end());
      }
    }
  }
  print_mean("all", 0, all);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    std::vector<std::string> words(argv + 1, argv + argc);
    palpate::Plan plan;
    if (!words.empty() && words[0] == "patches") {
      plan.patches = true;
      words.erase(words.begin());
    }
    words.resize(5);
    const auto number = [&](std::size_t i, unsigned otherwise) {
      return words[i].empty() ? otherwise : static_cast<unsigned>(std::stoul(words[i]));
    };
    plan.seeds = number(0, plan.seeds);
    plan.only = words[1];
    plan.refinements = static_cast<int>(number(2, 4));
    plan.first_seed = number(3, plan.first_seed);
    plan.probes = number(4, plan.probes);
    palpate::study_all(plan);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "field_study: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
