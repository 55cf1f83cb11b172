// Memory at sites of the surface against what is known to be right, and against the
// naive way.
//
// memory_study half-space    boundary elements of a viscoelastic half-space: programmes
//                            that slide, lift and come back, by spacing of the sites
// memory_study bundles       unloading, against 4000 springs touched one after another
// memory_study rival [RUNS]  history carried with the contact: what it creates
#include <cstdlib>
#include <exception>
#include <numbers>
#include <random>
#include <string>

#include <Eigen/LU>
#include <fmt/format.h>

#include "tests/bench/touched_springs.h"
#include "tests/bench/viscoelastic_half_space.h"
#include "tests/support/relaxing_body.h"

namespace palpate {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// ---- half-space

constexpr double kRadiusM = 0.005;
constexpr double kModulusPa = 12500.0;
constexpr double kStepS = 0.0025;

struct SlidingProgramme {
  const char* name;
  DepthPath x_m;
  DepthPath depth_m;
  double seconds;
};

std::vector<SlidingProgramme> sliding_programmes() {
  const auto back = [](double away_m) {
    const double x = away_m == 0.010 ? 0.008 : 0.011;
    return line_path({{0.0, x},
                      {1.1, x},
                      {1.25, x + away_m},
                      {1.5, x + away_m},
                      {1.65, x},
                      {3.0, x}});
  };
  const DepthPath lifted = line_path({{0.0, -0.0003},
                                      {0.1, 0.0025},
                                      {1.1, 0.0025},
                                      {1.15, -0.001},
                                      {1.25, -0.001},
                                      {1.3, 0.0025},
                                      {1.5, 0.0025},
                                      {1.55, -0.001},
                                      {1.65, -0.001},
                                      {1.75, 0.0025},
                                      {2.4, 0.0025}});
  const DepthPath pressed = line_path({{0.0, -0.0003}, {0.1, 0.0025}, {9.0, 0.0025}});
  return {{"press, hold, slide 10 mm, hold",
           line_path({{0.0, 0.008}, {0.7, 0.008}, {1.2, 0.018}, {2.0, 0.018}}), pressed,
           1.8},
          {"slide to and fro 4 mm at 1 Hz",
           [](double t) {
             return 0.013 + 0.004 * std::sin(kTurn * t);
           },
           pressed, 3.0},
          {"lift, press 10 mm away, come back", back(0.010), lifted, 2.4},
          {"the same, one contact radius away", back(0.0035), lifted, 2.4}};
}

BenchBody flat_body(double site_spacing_m) {
  constexpr double kDepthM = 0.005;
  BenchBodyOptions options{
      .cells = 24,
      .cell_m = 0.5 * site_spacing_m,
      .force_n = 4.0 / 3.0 * kModulusPa * std::sqrt(kRadiusM) * std::pow(kDepthM, 1.5),
      .depth_m = kDepthM,
      .samples = 48,
      .cells_per_site = 2};
  set_terms(options, kPork);
  return make_bench_body(options);
}

// rms of the normal force's difference over its own.
double sliding_error(const SlidingProgramme& programme, double scale,
                     const std::vector<double>& wanted_n, double spacing_m) {
  const BenchBody body = flat_body(spacing_m);
  const auto state = free_state(LocalModel::kPotential, 0.0);
  const double middle_m = std::round(0.5 * body.side_m() / spacing_m) * spacing_m;
  ForceError error;
  int tick = 0;
  for (std::size_t i = 1; i < wanted_n.size(); ++i) {
    for (int sub = 1; sub <= 5; ++sub) {
      const double t = static_cast<double>(i - 1) * kStepS + sub * kStepS / 5.0;
      const double x =
          std::sqrt(scale) * (programme.x_m(t) - 0.013) + middle_m + 0.37 * spacing_m;
      const Eigen::Vector3d at(x, middle_m + 1e-6, -scale * programme.depth_m(t));
      if (tick++ % 20 == 0) {
        send(*state, body, at);
      }
      const FastCommand command = step(*state, {at, 0}, kStepS / 5.0);
      if (sub == 5) {
        error.add(command.force_n.z(), wanted_n[i]);
      }
    }
  }
  return error.rms();
}

void against_half_space() {
  fmt::print("rms of normal force, %; sites apart by so many contact radii\n");
  fmt::print("{:<36}{:>6}{:>8}{:>8}{:>8}{:>8}{:>8}\n", "programme", "a/mm", "3", "2.5",
             "2", "1.5", "1");
  for (const double scale : {1.0, 0.5}) {
    const double contact_m = std::sqrt(kRadiusM * 0.0025 * scale);
    for (const SlidingProgramme& programme : sliding_programmes()) {
      ViscoelasticHalfSpace truth(52, 22, 0.0005, kRadiusM, kPork);
      std::vector<double> wanted_n{0.0};
      for (int i = 1; i * kStepS <= programme.seconds; ++i) {
        const double t = i * kStepS;
        wanted_n.push_back(
            kModulusPa *
            truth.step(0.013 + std::sqrt(scale) * (programme.x_m(t) - 0.013),
                       scale * programme.depth_m(t), kStepS)[0]);
      }
      fmt::print("{:<36}{:>6.2f}", programme.name, 1e3 * contact_m);
      for (const double radii : {3.0, 2.5, 2.0, 1.5, 1.0}) {
        fmt::print("{:>8.2f}", 100.0 * sliding_error(programme, scale, wanted_n,
                                                     radii * contact_m));
      }
      fmt::print("\n");
    }
  }
}

// ---- bundles

double bundle_error(const DepthPath& depth_m, double seconds, int bundles) {
  BenchBodyOptions options{.force_n = 2.0 * std::pow(0.008 / 0.005, 1.5),
                           .depth_m = 0.008,
                           .samples = 48,
                           .bundles = bundles};
  set_terms(options, kPork);
  const BenchBody body = make_bench_body(options);
  PressedPlace place(body, LocalModel::kPotential, {0.031, 0.029});
  TouchedSprings springs(kPork);
  ForceError error;
  const double dt_s = 1.0 / 2000.0;
  for (int i = 1; i * dt_s <= seconds; ++i) {
    double wanted_n = 0.0;
    for (int sub = 1; sub <= 4; ++sub) {
      wanted_n = springs.step(depth_m((i - 1 + 0.25 * sub) * dt_s), 0.25 * dt_s);
    }
    error.add(place.press(depth_m(i * dt_s), dt_s), wanted_n);
  }
  return error.rms();
}

void against_springs() {
  const std::vector<std::pair<const char*, DepthPath>> programmes{
      {"press, hold, retract 12 mm/s",
       line_path({{0.0, -0.0005}, {0.1, 0.005}, {1.5, 0.005}, {2.0, -0.001}})},
      {"sine 2 Hz, contact lost", sine_path(0.004, 0.002, 2.0)},
      {"sine 0.5 Hz in contact",
       [](double t) {
         return t < 0.1 ? -0.0005 + 0.035 * t
                        : 0.004 - 0.001 * std::cos(0.5 * kTurn * (t - 0.1));
       }},
      {"press deep, lift, press shallow", line_path({{0.0, -0.0005},
                                                     {0.1, 0.006},
                                                     {1.0, 0.006},
                                                     {1.1, -0.001},
                                                     {1.3, -0.001},
                                                     {1.4, 0.003},
                                                     {2.0, 0.003}})},
      {"stepwise retract", line_path({{0.0, -0.0005},
                                      {0.1, 0.006},
                                      {0.6, 0.006},
                                      {0.65, 0.0045},
                                      {1.1, 0.0045},
                                      {1.15, 0.003},
                                      {1.6, 0.003},
                                      {1.65, 0.0015},
                                      {2.0, 0.0015}})}};
  fmt::print("rms of force, %, by bundles\n{:<36}{:>8}{:>8}{:>8}{:>8}\n", "programme",
             1, 2, 4, 8);
  for (const auto& [name, path] : programmes) {
    fmt::print("{:<36}", name);
    for (const int bundles : {1, 2, 4, 8}) {
      fmt::print("{:>8.2f}", 100.0 * bundle_error(path, 2.0, bundles));
    }
    fmt::print("\n");
  }
}

// ---- rival

// Fung's increments with one history that goes where the contact goes, and the normal
// force alone.
class CarriedHistory {
 public:
  CarriedHistory(const BenchBody& body, const PronyTerms2& terms)
      : body_(body), terms_(terms) {}

  // Work of the tool on a straight way [J], then time passes.
  double step(const Eigen::Vector3d& to, double dt_s) {
    const double before_n = force_n_;
    const double elastic_n = elastic_force_n(to);
    double force_n = (1.0 - terms_.g[0] - terms_.g[1]) * elastic_n;
    for (std::size_t k = 0; k < 2; ++k) {
      held_n_[k] = std::exp(-dt_s / terms_.tau_s[k]) *
                   (held_n_[k] + terms_.g[k] * (elastic_n - elastic_n_));
      force_n += held_n_[k];
    }
    const double work_j = 0.5 * (before_n + std::max(0.0, force_n)) * (x_.z() - to.z());
    elastic_n_ = elastic_n;
    force_n_ = std::max(0.0, force_n);
    x_ = to;
    return work_j;
  }

  [[nodiscard]] double stiffest_j() const {
    double most = 0.0;
    for (const Element& element : body_.element) {
      for (const ElementNode& node : element.node) {
        most = std::max(most, node.curve().at(0.005).energy_j);
      }
    }
    return most;
  }

 private:
  [[nodiscard]] double elastic_force_n(const Eigen::Vector3d& x) const {
    const Element& element =
        body_.element[static_cast<std::size_t>(body_.triangle_at(x))];
    const auto place = [&](std::size_t j) {
      const auto& p = element.node[j].position_m;
      return Eigen::Vector2d(p[0], p[1]);
    };
    Eigen::Matrix2d edges;
    edges << place(1) - place(0), place(2) - place(0);
    const Eigen::Vector2d w = edges.inverse() * (x.head<2>() - place(0));
    const double weight[] = {1.0 - w.sum(), w[0], w[1]};
    double force_n = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      force_n += weight[j] * element.node[j].curve().at(-x.z()).force_n;
    }
    return force_n;
  }

  const BenchBody& body_;
  PronyTerms2 terms_;
  std::array<double, 2> held_n_{};
  double elastic_n_ = 0.0;
  double force_n_ = 0.0;
  Eigen::Vector3d x_ = Eigen::Vector3d(0.02, 0.02, 0.0005);
};

struct Creation {
  int programmes = 0;  // in which energy came out
  double worst = 0.0;  // least work over the stiffest node's deepest press
};

void note(Creation& creation, double least_j, double stiffest_j) {
  creation.programmes += least_j < -1e-12 ? 1 : 0;
  creation.worst = std::min(creation.worst, least_j / stiffest_j);
}

// Stations over one triangle, visited six times: its corners, the middles of its edges,
// its centroid.
std::vector<std::array<double, 4>> stations_of(std::mt19937& random) {
  constexpr std::array<std::array<double, 2>, 7> kPlaces{{{0.020, 0.020},
                                                          {0.030, 0.020},
                                                          {0.030, 0.030},
                                                          {0.025, 0.020},
                                                          {0.025, 0.025},
                                                          {0.030, 0.025},
                                                          {0.08 / 3.0, 0.07 / 3.0}}};
  std::uniform_real_distribution<double> unit;
  std::vector<std::array<double, 4>> stations(3 + random() % 4);  // x, y, z, hold
  for (auto& s : stations) {
    const auto& place = kPlaces[random() % kPlaces.size()];
    s = {place[0] + 1e-6, place[1] + 1e-6,
         unit(random) < 0.25 ? 0.0005 : -0.005 * unit(random),
         0.003 * std::pow(600.0, unit(random))};
  }
  return stations;
}

void wander(int run, const PronyTerms2& terms, Creation& rival, Creation& ours) {
  BenchBodyOptions options{.cells = 4,
                           .cell_m = 0.01,
                           .depth_m = 0.005,
                           .contrast = 31.6,
                           .seed = static_cast<std::uint32_t>(run)};
  set_terms(options, terms);
  const BenchBody body = make_bench_body(options);
  const auto state = free_state(LocalModel::kPotential, 0.0);
  CarriedHistory carried(body, terms);
  Account account;
  double net_j = 0.0;
  double least_j = 0.0;
  int tick = 0;
  const auto go = [&](const Eigen::Vector3d& to, double dt_s) {
    for (Element element : body.element) {
      element.active = element.triangle == body.triangle_at(to);
      if (tick % 10 == 0) {
        accept(*state, element);
      }
    }
    ++tick;
    relax_ahead(*state, dt_s);
    (void)account.step(*state, to, dt_s);
    net_j += carried.step(to, dt_s);
    least_j = std::min(least_j, net_j);
  };
  std::mt19937 random(static_cast<unsigned>(run));
  const auto stations = stations_of(random);
  Eigen::Vector3d x(0.02, 0.02, 0.0005);
  for (std::size_t visit = 0; visit < 6 * stations.size(); ++visit) {
    const auto& s = stations[visit % stations.size()];
    const Eigen::Vector3d from = x;
    for (int i = 1; i <= 100; ++i) {
      x = from + i / 100.0 * (Eigen::Vector3d(s[0], s[1], s[2]) - from);
      go(x, 0.00025);
    }
    for (double left_s = s[3]; left_s > 0.0; left_s -= 0.005) {
      go(x, std::min(left_s, 0.005));
    }
  }
  note(rival, least_j, carried.stiffest_j());
  note(ours, account.lowest_j, carried.stiffest_j());
}

void against_rival(int runs) {
  for (const PronyTerms2& terms : {kPork, kShortTimes}) {
    Creation rival;
    Creation ours;
    for (int run = 1; run <= runs; ++run) {
      wander(run, terms, rival, ours);
    }
    fmt::print(
        "tau {} s, {} s: carried history creates energy in {} of {} programmes, at "
        "most "
        "{:.0f} % of the stiffest node's deepest press; memory at sites in {}, {:.2g} "
        "%\n",
        terms.tau_s[0], terms.tau_s[1], rival.programmes, runs, -100.0 * rival.worst,
        ours.programmes, -100.0 * ours.worst);
  }
}

int run(const std::string& task, int runs) {
  if (task == "half-space") {
    against_half_space();
  } else if (task == "bundles") {
    against_springs();
  } else if (task == "rival") {
    against_rival(runs);
  } else {
    fmt::print(stderr, "memory_study half-space | bundles | rival [RUNS]\n");
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::run(argc > 1 ? argv[1] : "", argc > 2 ? std::atoi(argv[2]) : 1500);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
