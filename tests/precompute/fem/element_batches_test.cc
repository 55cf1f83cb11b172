// Elements in lanes against the same elements one by one, for every law.
#include "precompute/fem/element_batches.h"

#include <cstring>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "precompute/lanes/instruction_set.h"

namespace palpate {
namespace {

struct Case {
  const char* name;
  Material material;
};

std::vector<Case> cases() {
  const std::array<double, 2> mu{1500.0, -200.0};
  const std::array<double, 2> alpha{2.5, -3.0};
  return {
      {"linear", linear(5000.0, 0.45)},
      {"linear, auxetic", linear(5000.0, -0.3)},
      {"St. Venant-Kirchhoff", st_venant_kirchhoff(5000.0, 0.3)},
      {"St. Venant-Kirchhoff, auxetic", st_venant_kirchhoff(5000.0, -0.2)},
      {"neo-Hookean", neo_hookean(5000.0, 0.49)},
      {"Mooney-Rivlin", mooney_rivlin(700.0, 300.0, 0.45)},
      {"Ogden", ogden(mu, alpha, 0.45)},
      {"fibres", fibre_exponential(5000.0, 0.45, 20000.0, 2.0, {1.0, 2.0, 0.5})},
      {"transversely isotropic", transversely_isotropic(9000.0, 3000.0, 1500.0, 0.2,
                                                        0.3, {0.0, 1.0, 1.0}, true)}};
}

// Tets by chance, of some millimetres, each with nodes of its own.
struct Elements {
  static constexpr Eigen::Index kCount = 19;  // two batches and a part
  NodeGroups node;
  std::vector<ElementGeometry> geometry;
  std::vector<std::int32_t> region;
  Eigen::VectorXd u_m;

  explicit Elements(double strain) : node(kCount, 10), u_m(30 * kCount) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (Eigen::Index e = 0; e < kCount; ++e) {
      Eigen::Matrix<double, 4, 3> corners;
      corners << 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0;
      for (double& x : corners.reshaped()) {
        x = 4e-3 * (x + 0.2 * uniform(random));
      }
      geometry.push_back(element_geometry(corners, e));
      region.push_back(e % 3 == 0 ? 1 : 0);
      for (Eigen::Index a = 0; a < 10; ++a) {
        node(e, a) = static_cast<std::int32_t>(10 * e + a);
      }
    }
    for (double& u : u_m) {
      u = 4e-3 * strain * uniform(random);
    }
  }

  [[nodiscard]] ElementLinearisation one(const std::vector<Material>& materials,
                                         Eigen::Index e, bool convex) const {
    const auto i = static_cast<std::size_t>(e);
    return element_response(geometry[i], materials[static_cast<std::size_t>(region[i])],
                            u_m.segment<30>(30 * e), convex);
  }
};

ElementMatrix stiffness_of(const BatchResponse& response, std::size_t lane) {
  ElementMatrix K;
  for (Eigen::Index a = 0, block = 0; a < 10; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b, ++block) {
      for (Eigen::Index k = 0; k < 9; ++k) {
        const double entry = response.stiffness[block][k][lane];
        K(3 * a + k % 3, 3 * b + k / 3) = entry;
        K(3 * b + k / 3, 3 * a + k % 3) = entry;
      }
    }
  }
  return K;
}

TEST(ElementBatches, AreTheElementsOneByOne) {
  for (const Case& law : cases()) {
    const std::vector<Material> materials{law.material, neo_hookean(3000.0, 0.4)};
    for (const double strain : {1e-9, 0.02, 0.08}) {
      const Elements elements(strain);
      const ElementBatches batches(elements.node, elements.geometry, elements.region,
                                   materials);
      // One by one F - 1 is formed from F, whose rounding is that of 1.
      const double digits = 1e-12 + 1e-14 / strain;
      Eigen::VectorXd force = Eigen::VectorXd::Zero(elements.u_m.size());
      Eigen::Index seen = 0;
      batches.linearise(
          elements.u_m, false, [&](const auto& batch, const BatchResponse& response) {
            batches.add_forces(batch, response, force);
            for (std::size_t lane = 0; lane < batch.count; ++lane, ++seen) {
              const ElementLinearisation one =
                  elements.one(materials, batch.element[lane], false);
              EXPECT_LT((stiffness_of(response, lane) - one.stiffness).norm(),
                        1e-12 * one.stiffness.norm())
                  << law.name << " " << strain;
              EXPECT_NEAR(response.energy_j[lane], one.energy_j, digits * one.energy_j)
                  << law.name << " " << strain;
            }
          });
      EXPECT_EQ(seen, Elements::kCount);
      double energy_j = 0.0;
      double jacobian = 1.0;
      for (Eigen::Index e = 0; e < Elements::kCount; ++e) {
        const ElementLinearisation one = elements.one(materials, e, false);
        EXPECT_LT(
            (force.segment<30>(30 * e) - one.force_n).norm(),
            digits * one.stiffness.norm() * elements.u_m.segment<30>(30 * e).norm())
            << law.name << " " << strain;
        const auto i = static_cast<std::size_t>(e);
        energy_j += one.energy_j;
        jacobian = std::min(
            jacobian,
            smallest_jacobian(elements.geometry[i], elements.u_m.segment<30>(30 * e)));
      }
      const ElementBatches::Energy all = batches.energy(elements.u_m);
      EXPECT_NEAR(all.energy_j, energy_j, digits * energy_j)
          << law.name << " " << strain;
      EXPECT_NEAR(all.smallest_jacobian, jacobian, 1e-12) << law.name;
    }
  }
}

TEST(ElementBatches, DoNotAdmitElementsThatAreInsideOut) {
  for (const Material& material :
       {Material(neo_hookean(5000.0, 0.45)),
        Material(mooney_rivlin(700.0, 300.0, 0.45)),
        Material(fibre_exponential(5000.0, 0.45, 2e4, 2.0, {1.0, 0.0, 0.0}))}) {
    const std::vector<Material> materials{material, material};
    Elements elements(0.05);
    const auto corner = [&](Eigen::Index a) {
      return elements.u_m.segment<3>(30 * 13 + 3 * a);
    };
    corner(3).z() -= 0.02;
    const ElementBatches batches(elements.node, elements.geometry, elements.region,
                                 materials);
    const ElementBatches::Energy all = batches.energy(elements.u_m);
    EXPECT_EQ(all.energy_j, std::numeric_limits<double>::infinity());
    EXPECT_LT(all.smallest_jacobian, 0.0);
  }
}

// Convex answers are those of the elements one by one, and have no negative eigenvalue
// that counts.
TEST(ElementBatches, AreMadeConvexWhereTheyAreNot) {
  const std::vector<Material> materials{neo_hookean(5000.0, 0.49),
                                        neo_hookean(3000.0, 0.4)};
  const Elements elements(0.1);
  const ElementBatches batches(elements.node, elements.geometry, elements.region,
                               materials);
  int changed = 0;
  std::vector<ElementMatrix> plain(Elements::kCount);
  batches.linearise(elements.u_m, false,
                    [&](const auto& batch, const BatchResponse& response) {
                      for (std::size_t lane = 0; lane < batch.count; ++lane) {
                        plain[static_cast<std::size_t>(batch.element[lane])] =
                            stiffness_of(response, lane);
                      }
                    });
  batches.linearise(
      elements.u_m, true, [&](const auto& batch, const BatchResponse& response) {
        for (std::size_t lane = 0; lane < batch.count; ++lane) {
          const ElementMatrix K = stiffness_of(response, lane);
          const ElementMatrix& before =
              plain[static_cast<std::size_t>(batch.element[lane])];
          const double mean = before.diagonal().mean();
          const auto least = [](const ElementMatrix& A) {
            return Eigen::SelfAdjointEigenSolver<ElementMatrix>(A).eigenvalues()[0];
          };
          if (least(before) < -0.011 * mean) {
            ++changed;
            EXPECT_LT((K - elements.one(materials, batch.element[lane], true).stiffness)
                          .norm(),
                      1e-12 * K.norm());
          } else if (least(before) > -0.009 * mean) {
            EXPECT_EQ(K, before);
          }
          EXPECT_GT(least(K), -0.011 * mean);
        }
      });
  EXPECT_GT(changed, 0);
  EXPECT_LT(changed, Elements::kCount);
}

TEST(ElementBatches, HaveTheSameBitsWithEveryInstructionSet) {
  const Elements elements(0.1);
  for (const Case& law : cases()) {
    const std::vector<Material> materials{law.material, law.material};
    const ElementBatches batches(elements.node, elements.geometry, elements.region,
                                 materials);
    ElementBatch geometry;
    std::array<double, kElementUnknowns * kBatch> u{};
    batches.linearise(elements.u_m, false, [&](const auto& batch, const auto&) {
      geometry = batch.geometry;
      for (std::size_t lane = 0; lane < kBatch; ++lane) {
        for (std::size_t i = 0; i < kElementUnknowns; ++i) {
          u[i * kBatch + lane] =
              elements.u_m[30 * batch.element[lane] + static_cast<Eigen::Index>(i)];
        }
      }
    });
    const BatchLaw numbers = batch_law(law.material);
    BatchResponse baseline;
    std::array<double, kBatch> energy{};
    std::array<double, kBatch> jacobian{};
    const ElementKernels& slowest = element_kernels(InstructionSet::kBaseline);
    slowest.linearise(geometry, numbers, u.data(), baseline);
    slowest.energy(geometry, numbers, u.data(), energy.data(), jacobian.data());
    for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      if (set > instruction_set()) {
        continue;
      }
      BatchResponse response;
      std::array<double, kBatch> other_energy{};
      std::array<double, kBatch> other_jacobian{};
      element_kernels(set).linearise(geometry, numbers, u.data(), response);
      element_kernels(set).energy(geometry, numbers, u.data(), other_energy.data(),
                                  other_jacobian.data());
      EXPECT_EQ(std::memcmp(&response, &baseline, sizeof response), 0) << law.name;
      EXPECT_EQ(energy, other_energy) << law.name;
      EXPECT_EQ(jacobian, other_jacobian) << law.name;
    }
  }
}

}  // namespace
}  // namespace palpate
