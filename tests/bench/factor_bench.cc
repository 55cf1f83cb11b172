// The speed of light of a linear build at all nodes: its columns, as many right-hand
// sides through the factor's own block solve and nothing else, and the ratio of both.
// The body is a box of gel in quadratic tets, held at its bottom; its top is pressed.
//
// How long a right-hand side alone takes with the factor's numbers, with those rounded
// to single precision, and beside 63 others. And how fast a factor's dense products are
// with every instruction set.
//
// Threads run over blocks in both, all cores. "ratio" is columns over solves, each the
// least of the repetitions so far; the median of a few counts.
#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include "formats/base/stopwatch.h"
#include "precompute/contact/contact_surface.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/linear_elasticity.h"
#include "precompute/fem/quadratic_mesh.h"
#include "precompute/lanes/factor_kernels.h"
#include "precompute/lanes/instruction_set.h"
#include "tests/support/box_tets.h"

namespace palpate {
namespace {

constexpr double kSide = 0.04;     // [m] of the box
constexpr double kNear = 0.02;     // [m] columns are kept within
constexpr double kYoung = 6000.0;  // [Pa]

struct Gel {
  QuadraticMesh mesh;
  Supports supports;
  ContactSurface contact;
  CholeskyFactor factor;
  std::vector<std::int32_t> top;  // contact nodes that have columns
};

std::vector<double> grid(int cells) {
  std::vector<double> at;
  for (int i = 0; i <= cells; ++i) {
    at.push_back(kSide * i / cells);
  }
  return at;
}

Gel make_gel(int cells) {
  const std::vector<double> at = grid(cells);
  const BoxTets box = box_tets(at, at, at);
  QuadraticMesh mesh = make_quadratic(box.tets, box.surface);
  const std::vector<Material> material{linear(kYoung, 0.45)};
  Supports supports = hold_where(mesh, [](const Eigen::Vector3d& p) {
    return p.z() < 1e-9;
  });
  ContactSurface contact = make_contact_surface(mesh);
  CholeskyFactor factor(reduce(assemble_stiffness(mesh, material), supports));
  std::vector<std::int32_t> top;
  for (std::size_t v = 0; v < contact.node.size(); ++v) {
    if (contact.node[v].position_m.z() > kSide - 1e-9) {
      top.push_back(static_cast<std::int32_t>(v));
    }
  }
  return {std::move(mesh), std::move(supports), std::move(contact), std::move(factor),
          std::move(top)};
}

void solve_columns(const Gel& gel) {
  const SurfaceCompliance compliance(gel.factor, gel.supports, gel.contact, gel.top,
                                     kNear, {}, nullptr);
  benchmark::DoNotOptimize(&compliance);
}

// Right-hand sides are made once; what a build does to make and to read them is not
// here.
void solve_alone(const Gel& gel, const Eigen::MatrixXd& block) {
  const std::size_t blocks =
      (gel.top.size() + SurfaceCompliance::kBlock - 1) / SurfaceCompliance::kBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t i) {
    const std::size_t left = gel.top.size() - i * SurfaceCompliance::kBlock;
    const Eigen::MatrixXd X =
        left >= SurfaceCompliance::kBlock
            ? gel.factor.solve(block)
            : gel.factor.solve(block.leftCols(static_cast<Eigen::Index>(left)));
    benchmark::DoNotOptimize(X.data());
  });
}

void columns_over_solves(benchmark::State& state) {
  const Gel gel = make_gel(static_cast<int>(state.range(0)));
  const Eigen::MatrixXd block = Eigen::MatrixXd::Ones(
      gel.factor.size(), static_cast<Eigen::Index>(SurfaceCompliance::kBlock));
  solve_alone(gel, block);  // workspaces are there from now on
  double columns_s = std::numeric_limits<double>::infinity();
  double solves_s = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    columns_s = std::min(columns_s, seconds_of([&] {
                           solve_columns(gel);
                         }));
    state.PauseTiming();
    solves_s = std::min(solves_s, seconds_of([&] {
                          solve_alone(gel, block);
                        }));
    state.ResumeTiming();
  }
  state.counters["tets"] = static_cast<double>(gel.mesh.tet.rows());
  state.counters["unknowns"] = static_cast<double>(gel.factor.size());
  state.counters["columns"] = static_cast<double>(gel.top.size());
  state.counters["columns_s"] = columns_s;
  state.counters["solves_s"] = solves_s;
  state.counters["ratio"] = columns_s / solves_s;
}
BENCHMARK(columns_over_solves)
    ->Arg(6)
    ->Arg(10)
    ->Arg(14)
    ->Iterations(3)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// Solves alone, with the numbers rounded or not; "beside" is the time of one of 64.
void alone(benchmark::State& state) {
  const Gel gel = make_gel(static_cast<int>(state.range(0)));
  std::vector<std::int64_t> all(static_cast<std::size_t>(gel.factor.size()));
  std::iota(all.begin(), all.end(), 0);
  const FactorPart exact = gel.factor.part(all);
  const FactorPart part = state.range(1) == 0 ? exact : exact.rounded();
  SolveRows block = SolveRows::Ones(exact.size(), kSolveWidthMax);
  double beside_s = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    beside_s = std::min(beside_s, seconds_of([&] {
                          exact.solve(block);
                        }));
  }
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(exact.size());
  for (auto _ : state) {
    Eigen::VectorXd x = ones;
    part.solve(x);
    benchmark::DoNotOptimize(x.data());
  }
  state.SetLabel(state.range(1) == 0 ? "as they are" : "rounded");
  state.counters["nonzeros"] = static_cast<double>(exact.nonzeros());
  state.counters["beside_ms"] = 1e3 * beside_s / static_cast<double>(kSolveWidthMax);
}
BENCHMARK(alone)->ArgsProduct({{5, 7, 10}, {0, 1}})->Unit(benchmark::kMillisecond);

// A product of the size that factors are made of, by an instruction set.
void product(benchmark::State& state) {
  const auto set = static_cast<InstructionSet>(state.range(0));
  if (set > instruction_set()) {
    state.SkipWithError("this processor does not have it");
    return;
  }
  const FactorKernels& kernels = factor_kernels(set);
  constexpr std::ptrdiff_t kRows = 512, kColumns = 64, kInner = 256;
  const std::vector<double> A(kRows * kInner, 1.0);
  const std::ptrdiff_t rows = kernels.product_rows(kRows);
  std::vector<double> C(static_cast<std::size_t>(rows * kColumns));
  std::vector<double> work(
      static_cast<std::size_t>(kernels.product_work(kRows, kColumns, kInner)));
  for (auto _ : state) {
    kernels.product(kRows, kColumns, kInner, A.data(), kRows, A.data(), kRows, C.data(),
                    rows, false, work.data());
    benchmark::DoNotOptimize(C.data());
  }
  state.SetLabel(name_of(set));
  state.counters["flops"] = benchmark::Counter(
      2.0 * kRows * kColumns * kInner, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(product)->Arg(0)->Arg(1)->Arg(2);

}  // namespace
}  // namespace palpate
