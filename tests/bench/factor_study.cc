// Where one machine ends: memory and time of the factor of ever larger bodies.
//
// factor_study [BYTES]
//
// Three kinds of bodies, finer from row to row until the next would need more than
// BYTES (default 4e9): a cylinder and the demo's organ, whose quadratic tets are as
// fine as their surface there and grow inwards, as a build's shared mesh; and a box of
// equal tets, the most that a body of so many unknowns can need. Fitted are powers, y =
// c x^p, by least squares of the logarithms over the larger half of the rows; they say
// the largest body for a memory.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/stopwatch.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/cholesky_factor.h"
#include "precompute/fem/linear_elasticity.h"
#include "precompute/process/peak_memory.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/tets/tetrahedralise.h"
#include "tests/support/box_tets.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

constexpr double kCylinderStep = 1.5;  // of edges
constexpr double kOrganStep = 2.0;
constexpr double kBoxStep = 1.25;
constexpr int kMostRows = 12;
constexpr double kGigabyte = 1e9;

struct Solid {
  TetMesh tets;
  Triangles surface;
  double held_below_m = 0.0;
};

struct Row {
  double triangles = 0.0;
  double tets = 0.0;
  double unknowns = 0.0;
  double nonzeros = 0.0;
  double factor_s = 0.0;
  double block_s = 0.0;
  double peak_bytes = 0.0;
};

Solid cylinder_of(int row) {
  const int rings = static_cast<int>(std::lround(5.0 * std::pow(kCylinderStep, row)));
  const SurfaceMesh surface = cylinder(0.02, 0.02, rings);
  return {tetrahedralise(surface), surface.triangle, 1e-9};
}

Solid organ_of(int row) {
  const SurfaceMesh surface = organ(3 + row);
  return {tetrahedralise(surface), surface.triangle, 0.002};
}

Solid box_of(int row) {
  const int cells = static_cast<int>(std::lround(6.0 * std::pow(kBoxStep, row)));
  std::vector<double> at;
  for (int i = 0; i <= cells; ++i) {
    at.push_back(0.04 * i / cells);
  }
  BoxTets box = box_tets(at, at, at);
  return {std::move(box.tets), std::move(box.surface), 1e-9};
}

Row measured(const Solid& solid) {
  restart_peak_memory();
  Row row{.triangles = static_cast<double>(solid.surface.rows()),
          .tets = static_cast<double>(solid.tets.tet.rows())};
  const QuadraticMesh mesh = make_quadratic(solid.tets, solid.surface);
  const std::vector<Material> gel{linear(6000.0, 0.45)};
  const Supports supports = hold_where(mesh, [&](const Eigen::Vector3d& p) {
    return p.z() < solid.held_below_m;
  });
  const Stiffness K = reduce(assemble_stiffness(mesh, gel), supports);
  std::optional<CholeskyFactor> factor;
  row.factor_s = seconds_of([&] {
    factor.emplace(K);
  });
  row.unknowns = static_cast<double>(factor->size());
  row.nonzeros = static_cast<double>(factor->factor_nonzeros());
  const Eigen::MatrixXd block = Eigen::MatrixXd::Ones(
      factor->size(), static_cast<Eigen::Index>(SurfaceCompliance::kBlock));
  row.block_s = seconds_of([&] {
    (void)factor->solve(block);
  });
  row.peak_bytes = static_cast<double>(peak_memory_bytes());
  return row;
}

struct Power {
  double factor = 0.0;
  double exponent = 0.0;
  [[nodiscard]] double at(double x) const { return factor * std::pow(x, exponent); }
};

Power fitted(const std::vector<Row>& rows, double Row::*x, double Row::*y) {
  double x_mean = 0.0;
  double y_mean = 0.0;
  for (const Row& row : rows) {
    x_mean += std::log(row.*x) / static_cast<double>(rows.size());
    y_mean += std::log(row.*y) / static_cast<double>(rows.size());
  }
  double xx = 0.0;
  double xy = 0.0;
  for (const Row& row : rows) {
    xx += (std::log(row.*x) - x_mean) * (std::log(row.*x) - x_mean);
    xy += (std::log(row.*x) - x_mean) * (std::log(row.*y) - y_mean);
  }
  return {std::exp(y_mean - xy / xx * x_mean), xy / xx};
}

void print_fits(const std::vector<Row>& all) {
  const std::vector<Row> rows(all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2),
                              all.end());
  if (rows.size() < 2) {
    return;
  }
  const Power nonzeros = fitted(rows, &Row::unknowns, &Row::nonzeros);
  const Power memory = fitted(rows, &Row::unknowns, &Row::peak_bytes);
  const Power time = fitted(rows, &Row::unknowns, &Row::factor_s);
  const Power tets = fitted(rows, &Row::unknowns, &Row::tets);
  const Power by_triangles = fitted(rows, &Row::triangles, &Row::peak_bytes);
  fmt::print(
      "  non-zeros = {:.3g} unknowns^{:.3f}; peak memory = {:.3g} B "
      "unknowns^{:.3f} = {:.3g} B triangles^{:.3f}; factor = {:.3g} s "
      "unknowns^{:.3f}\n",
      nonzeros.factor, nonzeros.exponent, memory.factor, memory.exponent,
      by_triangles.factor, by_triangles.exponent, time.factor, time.exponent);
  for (const double gigabytes : {8.0, 16.0, 24.0, 64.0, 256.0}) {
    const double unknowns =
        std::pow(gigabytes * kGigabyte / memory.factor, 1.0 / memory.exponent);
    fmt::print(
        "  {:4.0f} GB hold {:.2g} unknowns, {:.2g} tets, factorised in {:.0f} s\n",
        gigabytes, unknowns, tets.at(unknowns), time.at(unknowns));
  }
}

void study(const std::string& name, const std::function<Solid(int)>& solid_of,
           double times_bytes, double most_bytes) {
  fmt::print("{}\n{:>9} {:>9} {:>9} {:>11} {:>10} {:>11} {:>10}\n", name, "triangles",
             "tets", "unknowns", "non-zeros", "factor s", "block of 64", "peak GB");
  std::vector<Row> rows;
  for (int i = 0; i < kMostRows; ++i) {
    rows.push_back(measured(solid_of(i)));
    const Row& row = rows.back();
    fmt::print("{:9.0f} {:9.0f} {:9.0f} {:11.0f} {:10.2f} {:11.2f} {:10.3f}\n",
               row.triangles, row.tets, row.unknowns, row.nonzeros, row.factor_s,
               row.block_s, row.peak_bytes / kGigabyte);
    std::fflush(stdout);
    if (row.peak_bytes * times_bytes > most_bytes) {
      break;
    }
  }
  print_fits(rows);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const double most_bytes = argc > 1 ? std::atof(argv[1]) : 4e9;
  if (argc > 2 || !(most_bytes > 0.0)) {
    fmt::print(stderr, "usage: factor_study [BYTES]\n");
    return EXIT_FAILURE;
  }
  try {
    palpate::study("cylinder, tets growing inwards", palpate::cylinder_of,
                   std::pow(palpate::kCylinderStep, 2.5), most_bytes);
    palpate::study("organ, tets growing inwards", palpate::organ_of,
                   std::pow(palpate::kOrganStep, 2.5), most_bytes);
    palpate::study("box, equal tets", palpate::box_of, std::pow(palpate::kBoxStep, 4.0),
                   most_bytes);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "factor_study: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
