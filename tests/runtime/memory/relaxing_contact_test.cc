#include "runtime/memory/relaxing_contact.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/relaxing_body.h"

namespace palpate {
namespace {

constexpr double kReferenceS = 1.0 / 20000.0;

BenchBodyOptions flat(const PronyTerms2& terms) {
  BenchBodyOptions options{.depth_m = 0.008, .samples = 48};
  set_terms(options, terms);
  return options;
}

// Ticks of some substeps of the reference.
template <typename Substeps>
ForceError render(PressedPlace& place, const ElementCurve& curve,
                  const PronyTerms2& terms, const DepthProgramme& programme,
                  const Substeps& substeps) {
  RelaxationReference reference(terms);
  ForceError error;
  for (int i = 0; i * kReferenceS < programme.seconds;) {
    double wanted_n = 0.0;
    const int count = substeps();
    for (int k = 0; k < count; ++k) {
      ++i;
      wanted_n = reference.step(curve.at(programme.depth_m(i * kReferenceS)).force_n,
                                kReferenceS);
    }
    const double force_n =
        place.press(programme.depth_m(i * kReferenceS), count * kReferenceS);
    error.add(force_n, wanted_n);
  }
  return error;
}

class RelaxingContactTest : public testing::TestWithParam<LocalModel> {};

INSTANTIATE_TEST_SUITE_P(Models, RelaxingContactTest,
                         testing::Values(LocalModel::kPotential, LocalModel::kElement),
                         [](const auto& model) {
                           return std::string(name(model.param));
                         });

TEST_P(RelaxingContactTest, IsTheConvolutionWithinHalfAThousandth) {
  for (const PronyTerms2& terms : {kPork, kShortTimes}) {
    const BenchBody body = make_bench_body(flat(terms));
    for (const DepthProgramme& programme : depth_programmes()) {
      PressedPlace place(body, GetParam(), kPressedPlaces[3]);
      const ForceError error =
          render(place, body.element[0].node[0].curve(), terms, programme, [] {
            return 10;
          });
      EXPECT_LE(error.rms(), 5e-4) << programme.name << " " << terms.tau_s[0];
      EXPECT_EQ(place.state().memory.shortened, 0U) << programme.name;
    }
  }
}

TEST_P(RelaxingContactTest, AndWithinAThousandthWhereTicksAreIrregular) {
  for (const PronyTerms2& terms : {kPork, kShortTimes}) {
    const BenchBody body = make_bench_body(flat(terms));
    std::mt19937 random(3);
    std::uniform_int_distribution<int> substeps(1, 25);  // 0.05 to 1.25 ms
    for (const DepthProgramme& programme : depth_programmes()) {
      PressedPlace place(body, GetParam(), kPressedPlaces[3]);
      const ForceError error =
          render(place, body.element[0].node[0].curve(), terms, programme, [&] {
            return substeps(random);
          });
      EXPECT_LE(error.rms(), 1e-3) << programme.name << " " << terms.tau_s[0];
    }
  }
}

TEST_P(RelaxingContactTest, AHeldToolRelaxesTheSameAtANodeAnEdgeAndACentroid) {
  const BenchBody body = make_bench_body(flat(kPork));
  const DepthProgramme hold{"hold", line_path({{0.0, -0.001}, {0.12, 0.005}}), 10.0};
  for (const Eigen::Vector2d& at : kPressedPlaces) {
    PressedPlace place(body, GetParam(), at);
    const ForceError error =
        render(place, body.element[0].node[0].curve(), kPork, hold, [] {
          return 10;
        });
    EXPECT_LE(error.rms(), 1e-4) << at.transpose();
  }
}

TEST_P(RelaxingContactTest, EndsAtTheSlowLimitOfTheCurve) {
  const BenchBody body = make_bench_body(flat(kShortTimes));
  PressedPlace place(body, GetParam(), kPressedPlaces[3]);
  double force_n = 0.0;
  for (int i = 0; i < 4000; ++i) {
    force_n = place.press(std::min(0.005, 1e-5 * i), 0.0005);
  }
  const double whole_n = body.element[0].node[0].curve().at(0.005).force_n;
  EXPECT_NEAR(force_n, (1.0 - 0.8) * whole_n, 1e-9);
}

TEST_P(RelaxingContactTest, WithoutSharesItIsTheStaticResponse) {
  BenchBodyOptions options{.wave_m = 0.004, .contrast = 9.0, .touch_offset_m = 2e-4};
  const BenchBody still = make_bench_body(options);
  set_terms(options, {{0.0, 0.0}, {0.4, 4.0}});
  const BenchBody relaxing = make_bench_body(options);
  const auto a = free_state(GetParam(), 0.005);
  const auto b = free_state(GetParam(), 0.005);
  int n = 0;
  for (const Eigen::Vector3d& x : make_bench_walk(still, {.ticks = 20000})) {
    if (n++ % 20 == 0) {
      send(*a, still, x);
      send(*b, relaxing, x);
    }
    const FastCommand one = step(*a, {x, 0}, 0.0005);
    const FastCommand other = step(*b, {x, 0}, 0.0005);
    ASSERT_NEAR((one.force_n - other.force_n).norm(), 0.0, 1e-11) << n;
    ASSERT_EQ(one.in_contact, other.in_contact) << n;
  }
}

TEST_P(RelaxingContactTest, NeverPulls) {
  const BenchBody body = make_bench_body(flat(kShortTimes));
  PressedPlace place(body, GetParam(), kPressedPlaces[2]);
  const DepthPath shake = sine_path(0.004, 0.001, 7.0);
  int free = 0;
  for (int i = 0; i < 20000; ++i) {
    const double force_n = place.press(shake(i * 0.0005), 0.0005);
    ASSERT_GE(force_n, 0.0) << i;
    free += force_n == 0.0 ? 1 : 0;
  }
  EXPECT_GT(free, 5000);
}

TEST_P(RelaxingContactTest, ADentIsFeltUntilItHasGoneBack) {
  const BenchBody body = make_bench_body(flat(kPork));
  const auto touch_m = [&](double wait_s) {
    PressedPlace place(body, GetParam(), kPressedPlaces[3]);
    for (int i = 0; i < 20000; ++i) {
      place.press(std::min(0.005, 1e-5 * i), 0.0005);
    }
    for (int i = 0; i < 100; ++i) {
      place.press(-0.001, wait_s / 100.0);
    }
    for (double depth_m = 0.0;; depth_m += 1e-5) {
      if (place.press(depth_m, 1e-6) > 0.0) {
        return depth_m;
      }
    }
  };
  const double soon_m = touch_m(0.1);
  const double later_m = touch_m(3.0);
  const double last_m = touch_m(60.0);
  EXPECT_GT(soon_m, 0.0025);
  EXPECT_GT(soon_m, later_m + 3e-4);
  EXPECT_GT(later_m, 1e-4);
  EXPECT_LE(last_m, 1.1e-4);
}

// Two places of a body whose dents differ.
class FrozenField : public testing::Test {
 protected:
  FrozenField() {
    BenchBodyOptions options{.cell_m = 0.01,
                             .wave_m = 0.003,
                             .contrast = 9.0,
                             .tilt_rad = 0.2,
                             .touch_offset_m = 1e-4};
    set_terms(options, kPork);
    body_ = make_bench_body(options);
    for (int i = 0; i < 6000; ++i) {
      const double t = i * 0.0005;
      go({0.055 + 0.004 * std::sin(3.0 * t), 0.054 + 0.003 * std::sin(2.0 * t),
          0.005 - 0.004 + 0.001 * std::sin(5.0 * t)});
    }
  }

  void go(const Eigen::Vector3d& x, double dt_s = 0.0005) {
    if (n_++ % 20 == 0) {
      send(*state_, body_, x);
    }
    command_ = step(*state_, {x, 0}, dt_s);
  }

  BenchBody body_;
  std::unique_ptr<FastState> state_ = free_state(LocalModel::kPotential, 0.005);
  FastCommand command_;
  int n_ = 0;
};

TEST_F(FrozenField, ForceIsTheGradientOfThePotential) {
  const Eigen::Vector3d x(0.0561, 0.0532, 0.0012);
  go(x);
  const double h = 1e-7;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(axis);
    const double slope =
        (potential_j(*state_, x + step) - potential_j(*state_, x - step)) / (2.0 * h);
    // Central difference of energies of 1e-3 J, rounded to 1e-19 J.
    EXPECT_NEAR(command_.force_n(axis), -slope, 1e-8) << axis;
  }
  EXPECT_GT(command_.force_n.norm(), 0.05);
}

TEST_F(FrozenField, PotentialIsContinuousOverTheEdgesOfElements) {
  const Eigen::Vector3d from(0.0505, 0.0521, 0.0013);
  const Eigen::Vector3d to(0.0611, 0.0567, 0.0011);
  go(from);
  double last_j = potential_j(*state_, from);
  double largest_j = 0.0;
  for (int i = 1; i <= 20000; ++i) {
    const double now_j = potential_j(*state_, from + i / 20000.0 * (to - from));
    largest_j = std::max(largest_j, std::abs(now_j - last_j));
    last_j = now_j;
  }
  // 0.6 um at 2 N.
  EXPECT_LT(largest_j, 1.2e-6);
}

}  // namespace
}  // namespace palpate
