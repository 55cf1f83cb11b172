// palpate contact against closed forms and reference solutions: bodies pressed by rigid
// tools, small-strain ones and a neo-Hookean half-space.
//
// Prints one row per case: what is pressed, where on its curve, force over the
// reference, the bound it must keep, tets, contact
// nodes and seconds of one processor. Exit 1 if a bound is missed.
// An argument runs only the cases whose name and parameter hold it; --all runs the slow
// ones too.
//
// Every case stands in the table at the end: a body, how its mesh is graded, a tool and
// the forces that it must give.

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "tests/bench/pressed_block.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

using std::numbers::pi;

struct Case {
  std::string name;
  Body body;
  Grading grading;
  ToolShape tool = {};
  std::vector<Press> press = {};
  double bound = 0.0;  // [-] of |force / reference - 1|
  bool slow = false;   // only with --all: takes longer than 20 s
  bool stuck = false;  // references are then over the frictionless force
  bool large = false;  // the nonlinear body, all presses along one path
};

// Processor time of this process and of those that it has waited for (TetGen's).
double processor_s() {
  double seconds = 0.0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& time : {usage.ru_utime, usage.ru_stime}) {
      seconds +=
          static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
  }
  return seconds;
}

// Whether the bounds of all its rows are kept.
bool run(const Case& c) {
  const double began_s = processor_s();
  Bench bench(c.body, c.grading);
  bench.reach(c.tool, c.press.back().depth_m, c.grading.finest_m);
  bool kept = true;
  const std::vector<double> large_n =
      c.large ? bench.path_force_n(c.press) : std::vector<double>{};
  for (std::size_t i = 0; i < c.press.size(); ++i) {
    const Press& press = c.press[i];
    const double slipping_n =
        c.large ? large_n[i] : bench.press(press.depth_m).force_n.z();
    const double ratio =
        (c.stuck ? bench.stuck_force_n(press.depth_m) / slipping_n : slipping_n) /
        press.force_n;
    const bool within = std::abs(ratio - 1.0) <= c.bound;
    fmt::print("{:<28} {:<16} {:>8.4f} {:>7.1f} % {:>8} {:>6} {:>7.1f}{}\n", c.name,
               press.where, ratio, 100.0 * c.bound, bench.tets(), bench.patch(),
               processor_s() - began_s, within ? "" : "  MISSED");
    std::fflush(stdout);
    kept = kept && within;
  }
  return kept;
}

Grading around_rim(double finest, double growth) {
  return {.growth = growth,
          .finest_m = finest * kContactRadius_m,
          .circle_m = kContactRadius_m};
}

// Sphere on a half-space, at the largest depth and two smaller ones, on one mesh.
Case sphere_case(double nu) {
  const double a = kContactRadius_m;
  const double R = 50.0 * a;
  Case c{.name = fmt::format("sphere, nu {}", nu),
         .body = {.poissons_ratio = nu},
         .grading = {.growth = 0.4, .finest_m = 0.1 * a},
         .tool = sphere(R),
         .bound = 0.01};
  for (const double share : {1.0 / 16.0, 0.25, 1.0}) {
    const double d = share * a * a / R;
    c.press.push_back(
        {fmt::format("a/a_max {:.2f}", std::sqrt(share)), d,
         4.0 / 3.0 * c.body.plane_modulus_pa() * std::sqrt(R) * d * std::sqrt(d)});
  }
  return c;
}

// The rim is round on 0.02 % of the radius.
Case punch_case(double nu) {
  const double a = kContactRadius_m;
  const double d = 0.002 * a;
  Case c{.name = fmt::format("flat punch, nu {}", nu),
         .body = {.poissons_ratio = nu},
         .grading = around_rim(0.055, 1.5),
         .tool = flat_punch(a, 0.0002 * a),
         .bound = 0.01};
  c.press = {{"edge/a 0.0002", d, 2.0 * c.body.plane_modulus_pa() * a * d}};
  return c;
}

Case cone_case(double half_angle_deg) {
  const double a = kContactRadius_m;
  const double tangent = std::tan(half_angle_deg * pi / 180.0);
  const double d = 0.5 * pi * a / tangent;
  Case c{.name = fmt::format("cone, {:.0f} deg", half_angle_deg),
         .body = {},
         .grading = {.growth = 0.4, .finest_m = 0.1 * a},
         .tool = cone(half_angle_deg * pi / 180.0, 0.0),
         .bound = 0.01};
  for (const double share : {0.25, 0.5, 1.0}) {
    const double at = share * d;
    c.press.push_back({fmt::format("a/a_max {:.2f}", share), at,
                       2.0 / pi * c.body.plane_modulus_pa() * tangent * at * at});
  }
  return c;
}

Body layer(double a_over_h, double nu) {
  const double h = kContactRadius_m / a_over_h;
  return {
      .half_width_m = kContactRadius_m + 6.0 * h, .depth_m = h, .poissons_ratio = nu};
}

// A contact node straddles the rim, so that the punch acts as one that is smaller by
// about a seventh of the finest edge; thin layers feel its radius to the power 2.5.
Case layer_punch_case(double a_over_h, double nu, double kappa, double finest) {
  const double a = kContactRadius_m;
  const double d = 0.002 * a;
  Case c{.name = fmt::format("layer, punch, nu {}", nu),
         .body = layer(a_over_h, nu),
         .grading = around_rim(finest, 2.0),
         .tool = flat_punch(a, 0.0002 * a),
         .bound = 0.015};
  c.press = {{fmt::format("a/h {}", a_over_h), d,
              2.0 * c.body.plane_modulus_pa() * a * d * kappa}};
  return c;
}

Case layer_paraboloid_case(double a_over_h, double nu, double kappa, double chi) {
  const double a = kContactRadius_m;
  const double R = 50.0 * a;
  const double d = chi * a * a / R;
  const double G = 0.5 * kYoung_pa / (1.0 + nu);
  Case c{.name = fmt::format("layer, paraboloid, nu {}", nu),
         .body = layer(a_over_h, nu),
         .grading = around_rim(0.2, 0.7),
         .tool = sphere(R),
         .bound = 0.015};
  c.press = {{fmt::format("a/h {}", a_over_h), d,
              8.0 * G * a * d * kappa / (3.0 * (1.0 - nu))}};
  return c;
}

// Fibres along the normal: Hertz's law with M for E*.
Case transverse_case(const Transverse& moduli) {
  Case c = sphere_case(0.3);
  c.name = fmt::format("transverse, E {}:{}, G {}", moduli.youngs_along,
                       moduli.youngs_across, moduli.shear_along);
  c.body.transverse = moduli;
  c.bound = 0.015;
  c.grading = {.growth = 0.33, .finest_m = 0.1 * kContactRadius_m, .inside = true};
  for (Press& press : c.press) {
    press.force_n *= moduli.plane_modulus / (1.0 / (1.0 - 0.3 * 0.3));
  }
  return c;
}

// Force over mu R^2 at depths of d/R, from a reference solution of 0.3 %.
Case large_depth_case(double nu, std::span<const std::array<double, 2>> reference) {
  const double R = kContactRadius_m;
  const double mu = 0.5 * kYoung_pa / (1.0 + nu);
  Case c{.name = fmt::format("neo-Hookean, nu {}", nu),
         .body = {.half_width_m = 80.0 * R,
                  .depth_m = 160.0 * R,
                  .poissons_ratio = nu,
                  .neo_hookean_law = true},
         .grading = {.growth = 0.5, .finest_m = 0.1 * R},
         .tool = sphere(R),
         .bound = 0.015,
         .large = true};
  for (const auto& [depth, force] : reference) {
    c.press.push_back(
        {fmt::format("d/R {:.2f}", depth), depth * R, force * mu * R * R});
  }
  return c;
}

Case stuck_punch_case(double nu) {
  Case c = punch_case(nu);
  c.name = fmt::format("stuck punch, nu {}", nu);
  c.grading.finest_m = 0.15 * kContactRadius_m;  // the rim's error cancels
  c.stuck = true;
  c.press.front().where = "over slipping";
  c.press.front().force_n = (1.0 - nu) * std::log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu);
  return c;
}

// Layers: values computed anew for the problem of Hayes et al. (1972).
std::vector<Case> cases() {
  std::vector<Case> all{sphere_case(0.3), sphere_case(0.45), punch_case(0.3),
                        punch_case(0.45), cone_case(80.0)};
  struct Row {
    double a_over_h, nu, kappa, finest;
  };
  for (const Row& row : {Row{0.2, 0.3, 1.207, 0.06}, Row{1.0, 0.3, 2.484, 0.045},
                         Row{2.0, 0.3, 4.353, 0.04}, Row{0.2, 0.45, 1.252, 0.06},
                         Row{1.0, 0.45, 3.091, 0.03}, Row{2.0, 0.45, 6.421, 0.03},
                         Row{0.2, 0.4999, 1.281, 0.06}, Row{1.0, 0.4999, 3.619, 0.024},
                         Row{2.0, 0.4999, 9.149, 0.03}}) {
    all.push_back(layer_punch_case(row.a_over_h, row.nu, row.kappa, row.finest));
    all.back().slow = row.finest < 0.05;
  }
  struct RoundRow {
    double a_over_h, nu, kappa, chi;
  };
  for (const RoundRow& row :
       {RoundRow{0.2, 0.3, 1.131, 0.8876}, RoundRow{0.6, 0.3, 1.486, 0.7281},
        RoundRow{2.0, 0.3, 3.279, 0.5730}, RoundRow{0.2, 0.45, 1.159, 0.8678},
        RoundRow{0.6, 0.45, 1.619, 0.6849}, RoundRow{2.0, 0.45, 4.464, 0.5099},
        RoundRow{0.2, 0.4999, 1.175, 0.8563}, RoundRow{0.6, 0.4999, 1.709, 0.6586},
        RoundRow{2.0, 0.4999, 5.711, 0.4549}}) {
    all.push_back(layer_paraboloid_case(row.a_over_h, row.nu, row.kappa, row.chi));
  }
  for (const double nu : {0.0, 0.3, 0.45}) {
    all.push_back(stuck_punch_case(nu));
  }
  for (const Transverse& moduli : {Transverse{20, 10, 4, 0.3, 0.3, 15.631457},
                                   Transverse{40, 10, 4, 0.3, 0.4, 22.630196},
                                   Transverse{100, 10, 5, 0.4, 0.4, 40.625649}}) {
    all.push_back(transverse_case(moduli));
  }
  using Pairs = std::vector<std::array<double, 2>>;
  all.push_back(large_depth_case(
      0.3, Pairs{{0.1, 0.12231}, {0.2, 0.34732}, {0.5, 1.3704}, {1.0, 3.7906}}));
  all.push_back(large_depth_case(
      0.45, Pairs{{0.1, 0.15107}, {0.2, 0.42286}, {0.5, 1.6083}, {1.0, 4.2406}}));
  return all;
}

int study(const std::string& wanted, bool all) {
  fmt::print("{:<28} {:<16} {:>8} {:>9} {:>8} {:>6} {:>7}\n", "case", "parameter",
             "F/F_ref", "bound", "tets", "nodes", "s");
  int missed = 0;
  for (const Case& c : cases()) {
    const std::string title = c.name + ", " + c.press.front().where;
    if (title.find(wanted) == std::string::npos || (c.slow && !all)) {
      continue;
    }
    try {
      missed += run(c) ? 0 : 1;
    } catch (const std::exception& error) {
      fmt::print("{:<28} {}  MISSED\n", c.name, error.what());
      ++missed;
    }
  }
  fmt::print("{} missed a bound\n", missed == 0 ? "none" : fmt::format("{}", missed));
  return missed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  std::string wanted;
  bool all = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    all = all || argument == "--all";
    wanted = argument == "--all" ? wanted : argument;
  }
  return palpate::study(wanted, all);
}
