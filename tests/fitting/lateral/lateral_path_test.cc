#include "fitting/lateral/lateral_path.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/fitting/lateral/loop_simulation.h"

namespace palpate {
namespace {

LateralRun path_run(const SimulatedMotion& motion) {
  return simulate_loop({}, motion, 1).run;
}

TEST(LateralPath, TurnsLieBetweenSamples) {
  for (const double phase : {0.0, 0.1, 0.5, 0.9}) {
    const LateralPath path =
        find_lateral_path(path_run({.cycles = 2.0, .phase = phase}));
    ASSERT_EQ(path.turn.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      const LateralTurn& turn = path.turn[i];
      EXPECT_NEAR(turn.place_m, i % 2 == 0 ? 1e-3 : -1e-3, 1e-15) << phase;
      EXPECT_EQ(turn.after, 101U + 200U * i - (phase > 0.0 ? 1U : 0U)) << phase;
    }
  }
}

// A parabola misses a sine by its fourth order: (2 pi / 400)^4 / 24 of the amplitude at
// a sample's distance.
TEST(LateralPath, TurnsOfASineAreThoseOfItsParabola) {
  for (const double phase : {0.2, 0.7}) {
    const LateralPath path =
        find_lateral_path(path_run({.cycles = 2.0, .sine = true, .phase = phase}));
    ASSERT_EQ(path.turn.size(), 4U);
    EXPECT_NEAR(path.turn[1].place_m, -1e-3, 1e-3 * std::pow(0.0157, 4) / 6.0);
  }
}

TEST(LateralPath, TheForceResistsWhateverItsSign) {
  LateralRun run = path_run({.offset_n = 3.0});
  EXPECT_FALSE(find_lateral_path(run).force_turned);
  for (double& force : run.force_n) {
    force = -force;
  }
  EXPECT_TRUE(find_lateral_path(run).force_turned);
  for (double& x : run.displacement_m) {
    x = -x;
  }
  EXPECT_FALSE(find_lateral_path(run).force_turned);
}

// A spring that never slides takes no work in a closed loop.
TEST(LateralPath, ASpringsForceRisesWithTheDisplacement) {
  LateralRun run = path_run({.amplitude_m = 0.2e-3, .noise_n = 0.01});
  EXPECT_FALSE(find_lateral_path(run).force_turned);
  for (double& force : run.force_n) {
    force = -force;
  }
  EXPECT_TRUE(find_lateral_path(run).force_turned);
}

TEST(LateralPath, HoldsAreLeftOutButNotTheFirst) {
  LateralRun run = path_run({.cycles = 1.0});
  const auto hold = [&run](std::size_t at) {
    for (auto* values : {&run.displacement_m, &run.force_n, &run.normal_n}) {
      values->insert(values->begin() + static_cast<std::ptrdiff_t>(at), 20,
                     (*values)[at]);
    }
  };
  run.time_s.clear();
  hold(150);
  EXPECT_EQ(find_lateral_path(run).fitted.size(), run.force_n.size() - 20U);
  hold(0);
  EXPECT_EQ(find_lateral_path(run).fitted.size(), run.force_n.size() - 20U);
}

TEST(LateralPath, ApproachAndLiftOffAreNotInContact) {
  LateralRun run = path_run({.cycles = 1.0});
  for (std::size_t i = 0; i < 10; ++i) {
    run.normal_n[i] = 0.1 * static_cast<double>(i);
  }
  run.normal_n.back() = 0.0;
  const LateralPath path = find_lateral_path(run);
  EXPECT_EQ(path.apart, 6U);
  EXPECT_EQ(path.force_n.size(), run.force_n.size() - 6U);
  std::transform(run.normal_n.begin(), run.normal_n.end(), run.normal_n.begin(),
                 std::negate<>());
  EXPECT_DOUBLE_EQ(find_lateral_path(run).normal_n, path.normal_n);
}

TEST(LateralPath, RefusesWhatIsNoLateralTest) {
  const auto refuses = [](const std::function<void(LateralRun&)>& change,
                          const char* says) {
    LateralRun run = path_run({.cycles = 1.0});
    change(run);
    try {
      (void)find_lateral_path(run);
      ADD_FAILURE() << says;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos)
          << error.what();
    }
  };
  refuses(
      [](LateralRun& run) {
        run.force_n.pop_back();
      },
      "as many of each");
  refuses(
      [](LateralRun& run) {
        run.force_n[3] = NAN;
      },
      "sample 4");
  refuses(
      [](LateralRun& run) {
        run.displacement_m.assign(401, 1.0);
      },
      "move");
  refuses(
      [](LateralRun& run) {
        std::fill_n(run.normal_n.begin() + 190, 20, 0.0);
      },
      "normal force goes");
  refuses(
      [](LateralRun& run) {
        run.normal_n.clear();
        run.normal_stated_n = -1.0;
      },
      "normal force is -1 N");
}

}  // namespace
}  // namespace palpate
