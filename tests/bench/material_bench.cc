// What one evaluation of each law costs: energy alone, and stress with tangent.
#include <array>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "precompute/material/material.h"

namespace palpate {
namespace {

struct NamedLaw {
  const char* name;
  Material law;
};

const std::vector<NamedLaw>& laws() {
  static const Eigen::Vector3d fibre(1.0, 2.0, -0.5);
  static const std::vector<NamedLaw> all{
      {"linear", linear(5e3, 0.45)},
      {"st-venant-kirchhoff", st_venant_kirchhoff(5e3, 0.45)},
      {"neo-hookean", neo_hookean(5e3, 0.45)},
      {"mooney-rivlin", mooney_rivlin(700.0, 300.0, 0.45)},
      {"ogden-1", ogden(std::array{500.0}, std::array{8.0}, 0.45)},
      {"ogden-4", ogden(std::array{500.0, -200.0, 10.0, -5.0},
                        std::array{2.0, -2.0, 8.0, -6.0}, 0.45)},
      {"transversely-isotropic",
       transversely_isotropic(30e3, 8e3, 5e3, 0.4, 0.45, fibre, false)},
      {"transversely-isotropic-finite",
       transversely_isotropic(30e3, 8e3, 5e3, 0.4, 0.45, fibre, true)},
      {"fibre-exponential", fibre_exponential(5e3, 0.45, 2e3, 0.8, fibre)}};
  return all;
}

// Enough states that branches on the state are not learnt by heart.
std::vector<Eigen::Matrix3d> states() {
  std::srand(1);
  std::vector<Eigen::Matrix3d> all(1024);
  for (Eigen::Matrix3d& F : all) {
    F = Eigen::Matrix3d::Identity() + 0.2 * Eigen::Matrix3d::Random();
  }
  return all;
}

void energy(benchmark::State& state, const Material& law) {
  const std::vector<Eigen::Matrix3d> F = states();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(distortion_energy(law, F[i++ % F.size()]));
  }
}

void stress_and_tangent(benchmark::State& state, const Material& law) {
  const std::vector<Eigen::Matrix3d> F = states();
  std::size_t i = 0;
  for (auto _ : state) {
    LocalResponse local = distortion_response(law, F[i++ % F.size()]);
    benchmark::DoNotOptimize(local);
  }
}

const bool kRegistered = [] {
  for (const NamedLaw& named : laws()) {
    const std::string name = named.name;
    benchmark::RegisterBenchmark(("law_energy/" + name).c_str(), energy, named.law);
    benchmark::RegisterBenchmark(("law_response/" + name).c_str(), stress_and_tangent,
                                 named.law);
  }
  return true;
}();

}  // namespace
}  // namespace palpate
