#include "fitting/session/rigid_registration.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

const Eigen::Matrix3d kRotation =
    Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
const Eigen::Vector3d kShift(0.3, -0.1, 0.7);

std::vector<RegistrationPair> pairs(int count, double error_m, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, error_m > 0.0 ? error_m : 1.0);
  std::mt19937 places(7);
  std::uniform_real_distribution<double> place(-0.05, 0.05);
  std::vector<RegistrationPair> result;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d x(place(places), place(places), place(places));
    Eigen::Vector3d y = kRotation * x + kShift;
    for (Eigen::Index k = 0; k < 3 && error_m > 0.0; ++k) {
      y[k] += normal(generator);
    }
    result.push_back({std::to_string(i), x, y});
  }
  return result;
}

std::string complaint(const std::vector<RegistrationPair>& given) {
  try {
    (void)register_rigidly(given);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RigidRegistration, IsExactForExactPairs) {
  for (const int count : {3, 4, 12}) {
    const Registration r = register_rigidly(pairs(count, 0.0, 1));
    EXPECT_LT((r.rotation - kRotation).norm(), 1e-12);
    EXPECT_LT((r.shift_m - kShift).norm(), 1e-13);
    EXPECT_LT(r.rms_m, 1e-14);
    EXPECT_LT((r.to_mesh_m({1, 2, 3}) - (kRotation * Eigen::Vector3d(1, 2, 3) + kShift))
                  .norm(),
              1e-12);
  }
}

TEST(RigidRegistration, ThreeInAPlaneAreTurnedNeverMirrored) {
  const Registration r = register_rigidly(pairs(3, 2e-4, 3));
  EXPECT_NEAR(r.rotation.determinant(), 1.0, 1e-12);
}

TEST(RigidRegistration, ResidualsAndTargetErrorAreAsLargeAsTheirMean) {
  // 4000 registrations of 6 pairs with 0.5 mm in each direction: rms of what a point
  // far off is displaced, and of what was expected.
  const Eigen::Vector3d target(0.12, -0.05, 0.03);
  double real = 0.0, expected = 0.0, localisation = 0.0;
  constexpr int kRuns = 4000;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Registration r = register_rigidly(pairs(6, 5e-4, seed));
    const Eigen::Vector3d truth = kRotation * target + kShift;
    real += (r.to_mesh_m(target) - truth).squaredNorm();
    expected += std::pow(registration_error_m(r, truth), 2);
    localisation += std::pow(r.localisation_sd_m, 2);
  }
  EXPECT_NEAR(std::sqrt(localisation / kRuns), std::sqrt(3.0) * 5e-4, 1e-5);
  EXPECT_NEAR(std::sqrt(expected / real), 1.0, 0.03);
}

TEST(RigidRegistration, RefusesWhatLeavesATurnUnknown) {
  EXPECT_NE(complaint(pairs(2, 0.0, 1)).find("2 pairs, needs 3"), std::string::npos);
  auto line = pairs(5, 0.0, 1);
  for (std::size_t i = 0; i < line.size(); ++i) {
    line[i].machine_m = Eigen::Vector3d(0.01, 0.02, 0.03) * static_cast<double>(i);
    line[i].mesh_m = kRotation * line[i].machine_m;
  }
  EXPECT_NE(complaint(line).find("lie on a line"), std::string::npos);
  auto same = pairs(4, 0.0, 1);
  for (RegistrationPair& pair : same) {
    pair.machine_m = Eigen::Vector3d::Zero();
  }
  EXPECT_NE(complaint(same).find("lie on a line"), std::string::npos);
}

TEST(RigidRegistration, RefusesAMirrorAndOtherUnits) {
  auto mirrored = pairs(5, 1e-4, 2);
  for (RegistrationPair& pair : mirrored) {
    pair.machine_m.z() = -pair.machine_m.z();
  }
  EXPECT_NE(complaint(mirrored).find("only a mirror"), std::string::npos);
  auto millimetres = pairs(5, 0.0, 2);
  for (RegistrationPair& pair : millimetres) {
    pair.machine_m *= 1e3;
  }
  EXPECT_NE(complaint(millimetres).find("0.001 times as long"), std::string::npos)
      << complaint(millimetres);
}

TEST(RigidRegistration, NearlyFlatPairsWithErrorsAreNoMirror) {
  for (unsigned seed = 1; seed <= 500; ++seed) {
    auto flat = pairs(4, 5e-4, seed);
    for (RegistrationPair& pair : flat) {
      const Eigen::Vector3d error = pair.mesh_m - (kRotation * pair.machine_m + kShift);
      pair.machine_m.z() = 0.0;
      pair.mesh_m = kRotation * pair.machine_m + kShift + error;
    }
    EXPECT_EQ(complaint(flat), "") << seed;
  }
}

}  // namespace
}  // namespace palpate
