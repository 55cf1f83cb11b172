#include "runtime/fast/potential_field.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "formats/response/tilt_line.h"
#include "runtime/bench/bench_body.h"

namespace palpate {
namespace {

constexpr double kSphereRadiusM = 0.005;

Eigen::Vector3d random_vector(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  return {unit(random), unit(random), unit(random)};
}

std::array<double, 3> to_array(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// A triangle of 5 mm with normals that differ by up to 30 degrees and responses that
// differ a hundredfold.
Element random_element(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Element element;
  element.triangle = 0;
  const std::array<Eigen::Vector3d, 3> corner{
      {{0.0, 0.0, 0.0}, {0.005, 0.0, 0.0}, {0.002, 0.004, 0.0}}};
  for (std::size_t j = 0; j < 3; ++j) {
    ElementNode& node = element.node[j];
    node.node = static_cast<std::int32_t>(j);
    node.position_m = to_array(corner[j] + 5e-4 * random_vector(random));
    const Eigen::Vector3d n =
        (Eigen::Vector3d::UnitZ() + 0.25 * random_vector(random)).normalized();
    node.normal = to_array(n);
    const Eigen::Vector3d u = (n + 0.3 * random_vector(random)).normalized();
    node.direction = to_array(u);
    node.tilt = to_array(tilt_line(u, n).tilt);
    node.touch_offset_m = 2e-4 * (unit(random) - 0.5);
    set_power_law(node, 1.5, std::pow(100.0, unit(random) - 0.5), 0.008);
  }
  return element;
}

// A place in one element, at coordinates of its prism.
FieldPlace place_at(const ElementCache& cache, int slot, const PrismPoint& at) {
  FieldPlace place;
  place.kind = FieldKind::kFacets;
  place.slot = slot;
  place.prism = make_prism(cache.element[static_cast<std::size_t>(slot)]);
  set_facet(place, at, frame_at(place.prism, at, Beyond::kAnalytic));
  return place;
}

FieldResponse response_at(const ElementCache& cache, const FieldPlace& place) {
  CurvePieces pieces;
  return respond(place, cache, kSphereRadiusM, 0.0, pieces);
}

// A place in one element.
FieldPlace place_over(const ElementCache& cache, const Eigen::Vector3d& x,
                      FieldKind kind) {
  FieldPlace place;
  adopt(place, cache, 0, x, kind);
  return place;
}

FieldPlace smooth_place(const ElementCache& cache, const Eigen::Vector3d& x) {
  return place_over(cache, x, FieldKind::kSmooth);
}

// x at coordinates of the prism: the smooth field shares its faces and node lines.
Eigen::Vector3d position_at(const Element& element, const PrismPoint& at) {
  return frame_at(make_prism(element), at, Beyond::kAnalytic).position_m;
}

TEST(Prism, CoordinatesAreFoundAgain) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int n = 0; n < 1000; ++n) {
    const Prism prism = make_prism(random_element(random));
    PrismPoint wanted;
    wanted.area = Eigen::Vector3d(unit(random), unit(random), unit(random));
    wanted.area /= wanted.area.sum();
    wanted.height_m = kSphereRadiusM - 0.006 * unit(random);
    const Eigen::Vector3d x = frame_at(prism, wanted, Beyond::kAnalytic).position_m;
    PrismPoint found{Eigen::Vector3d::Constant(1.0 / 3.0), 0.003};
    PrismFrame frame;
    ASSERT_EQ(find_coordinates(prism, x, Beyond::kAnalytic, found, frame),
              PrismSolve::kFound);
    EXPECT_LT((found.area - wanted.area).norm(), 1e-12) << n;
    EXPECT_NEAR(found.height_m, wanted.height_m, 1e-15) << n;
  }
}

class BothFields : public testing::TestWithParam<FieldKind> {};

TEST_P(BothFields, ForceIsTheNegativeGradient) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.1, 1.0);
  auto cache = std::make_unique<ElementCache>();
  for (int n = 0; n < 1000; ++n) {
    *cache = {};
    const Element element = random_element(random);
    store(*cache, element);
    PrismPoint at;
    at.area = Eigen::Vector3d(unit(random), unit(random), unit(random));
    at.area /= at.area.sum();
    at.height_m = kSphereRadiusM - 0.006 * unit(random);
    const Eigen::Vector3d x = position_at(element, at);
    const FieldPlace place = place_over(*cache, x, GetParam());
    const FieldResponse response = response_at(*cache, place);
    constexpr double kStepM = 1e-7;
    Eigen::Vector3d difference;
    for (int i = 0; i < 3; ++i) {
      const auto energy_at = [&](double step) {
        FieldPlace moved = place;
        EXPECT_TRUE(follow_within(moved, x + step * Eigen::Vector3d::Unit(i)));
        return response_at(*cache, moved).energy_j;
      };
      difference(i) = (energy_at(-kStepM) - energy_at(kStepM)) / (2.0 * kStepM);
    }
    // Rounding of energies near 1e-3 J over 2e-7 m, and the third derivative's part.
    EXPECT_LT((difference - response.force_n).norm(),
              1e-6 * response.force_n.norm() + 1e-10)
        << n;
  }
}

TEST(PotentialField, ForceIsTheGradientInTheContinuedPlaneToo) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  auto cache = std::make_unique<ElementCache>();
  int checked = 0;
  for (int n = 0; n < 1000; ++n) {
    *cache = {};
    store(*cache, random_element(random));
    PrismPoint at;
    at.area = Eigen::Vector3d(1.0, 0.0, 0.0) + 0.8 * random_vector(random);
    at.area(2) = 1.0 - at.area(0) - at.area(1);
    at.height_m = kSphereRadiusM - 0.004 * unit(random);
    FieldPlace place = place_at(*cache, 0, at);
    set_facet(place, at, frame_at(place.prism, at, Beyond::kHeld));
    place.outside = at.area.minCoeff() < 0.0;
    const Eigen::Vector3d x = place.frame.position_m;
    const FieldResponse response = response_at(*cache, place);
    constexpr double kStepM = 1e-7;
    const Eigen::Vector3d step = kStepM * random_vector(random);
    FieldPlace plus = place;
    FieldPlace minus = place;
    if (!(place.outside && follow_within(plus, x + step) &&
          follow_within(minus, x - step))) {
      continue;
    }
    ++checked;
    const double work =
        response_at(*cache, minus).energy_j - response_at(*cache, plus).energy_j;
    EXPECT_NEAR(work / 2.0, response.force_n.dot(step),
                1e-5 * response.force_n.norm() * step.norm() + 1e-17)
        << n;
  }
  EXPECT_GT(checked, 300);
}

TEST(PotentialField, NormalForceIsTheInterpolatedCurve) {
  std::mt19937_64 random(7);
  auto cache = std::make_unique<ElementCache>();
  for (int n = 0; n < 200; ++n) {
    *cache = {};
    const Element element = random_element(random);
    store(*cache, element);
    const PrismPoint at{{0.2, 0.5, 0.3}, kSphereRadiusM - 0.004};
    const FieldPlace place = place_at(*cache, 0, at);
    const FieldResponse response = response_at(*cache, place);
    double wanted = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      const ElementNode& node = element.node[j];
      const double c =
          std::abs(Eigen::Map<const Eigen::Vector3d>(node.normal.data())
                       .dot(Eigen::Map<const Eigen::Vector3d>(node.direction.data())));
      wanted += at.area(static_cast<Eigen::Index>(j)) * c *
                node.curve().at(c * (0.004 - node.touch_offset_m)).force_n;
    }
    EXPECT_NEAR(response.force_n.dot(place.normal), wanted, 1e-9 * wanted);
  }
}

BenchBodyOptions stiff_and_soft() {
  BenchBodyOptions options;
  options.cells = 4;
  options.wave_m = 0.006;
  options.contrast = 100.0;
  options.tilt_rad = 0.2;
  options.tilt_by_height_per_m = 30.0;
  options.touch_height_m = kSphereRadiusM;
  options.touch_offset_m = 2e-4;
  return options;
}

// Every element of the body is at hand by its own cache, because one holds 16.
std::unique_ptr<ElementCache> cache_of(const Element& element) {
  auto cache = std::make_unique<ElementCache>();
  store(*cache, element);
  return cache;
}

TEST_P(BothFields, EnergyIsContinuousAcrossEdgesAndTheSmoothForceToo) {
  const BenchBody body = make_bench_body(stiff_and_soft());
  int edges = 0;
  for (const Element& element : body.element) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::int32_t next =
          element.neighbour[static_cast<std::size_t>((corner + 1) % 3)];
      if (next < 0) {
        continue;
      }
      const auto here = cache_of(element);
      const auto there = cache_of(body.element[static_cast<std::size_t>(next)]);
      for (const double along : {0.01, 0.3, 0.8}) {
        PrismPoint at;
        at.area((corner + 1) % 3) = along;
        at.area((corner + 2) % 3) = 1.0 - along;
        at.height_m = kSphereRadiusM - 0.005;
        const Eigen::Vector3d x = position_at(element, at);
        const FieldResponse one = response_at(*here, place_over(*here, x, GetParam()));
        const FieldResponse other =
            response_at(*there, place_over(*there, x, GetParam()));
        // The coordinates agree to 1e-13 of the element's size.
        EXPECT_NEAR(other.energy_j, one.energy_j, 1e-12 * one.energy_j);
        if (GetParam() == FieldKind::kSmooth) {
          EXPECT_LT((other.force_n - one.force_n).norm(), 1e-9 * one.force_n.norm());
        }
        ++edges;
      }
    }
  }
  EXPECT_GT(edges, 200);
}

INSTANTIATE_TEST_SUITE_P(Kinds, BothFields,
                         testing::Values(FieldKind::kSmooth, FieldKind::kFacets));

TEST(PotentialField, EnergyIsContinuousAroundVertices) {
  const BenchBody body = make_bench_body(stiff_and_soft());
  for (const double aside : {0.0, 1e-9, 1e-7}) {
    std::vector<double> lowest(25, 1e9);
    std::vector<double> highest(25, -1e9);
    for (const Element& element : body.element) {
      const auto cache = cache_of(element);
      for (int j = 0; j < 3; ++j) {
        PrismPoint at{Eigen::Vector3d::Constant(aside / 2.0), kSphereRadiusM - 0.005};
        at.area(j) = 1.0 - aside;
        const double energy = response_at(*cache, place_at(*cache, 0, at)).energy_j;
        const auto node =
            static_cast<std::size_t>(element.node[static_cast<std::size_t>(j)].node);
        lowest[node] = std::min(lowest[node], energy);
        highest[node] = std::max(highest[node], energy);
      }
    }
    for (std::size_t node = 0; node < lowest.size(); ++node) {
      // Neighbours store at most a hundred times as much.
      EXPECT_LE(highest[node] - lowest[node],
                100.0 * aside * highest[node] + 1e-15 * highest[node]);
    }
  }
}

TEST(PotentialField, FallsToZeroTowardsANodeWithoutResponse) {
  std::mt19937_64 random(11);
  Element element = random_element(random);
  element.node[2].samples = 0;
  element.node[2].direction = {};
  const auto cache = cache_of(element);
  double before = 0.0;
  for (const double there : {0.0, 0.3, 0.6, 0.9, 1.0}) {
    const PrismPoint at{{0.4 * (1.0 - there), 0.6 * (1.0 - there), there}, 0.0};
    const double energy = response_at(*cache, place_at(*cache, 0, at)).energy_j;
    if (there == 0.0) {
      before = energy;
      EXPECT_GT(energy, 0.0);
    }
    EXPECT_NEAR(energy, (1.0 - there) * before, 1e-12 * before);
  }
}

TEST(SmoothField, OnANodesLineTheForceIsTheStoredOneAtEveryDepth) {
  std::mt19937_64 random(16);
  auto cache = std::make_unique<ElementCache>();
  for (int n = 0; n < 300; ++n) {
    *cache = {};
    const Element element = random_element(random);
    store(*cache, element);
    const auto j = static_cast<std::size_t>(n % 3);
    const ElementNode& node = element.node[j];
    const Eigen::Map<const Eigen::Vector3d> normal(node.normal.data());
    const Eigen::Map<const Eigen::Vector3d> u(node.direction.data());
    for (const double depth : {0.0005, 0.002, 0.006}) {
      PrismPoint at;
      at.area = Eigen::Vector3d::Unit(static_cast<int>(j));
      at.height_m = kSphereRadiusM - depth;
      const FieldResponse response =
          response_at(*cache, smooth_place(*cache, position_at(element, at)));
      const double f =
          node.curve().at(normal.dot(u) * (depth - node.touch_offset_m)).force_n;
      EXPECT_LT((response.force_n - f * u).norm(), 1e-9 * f) << n;
    }
  }
}

TEST(SmoothField, TheFootIsUnderTheToolAndMovesWithIt) {
  std::mt19937_64 random(17);
  auto cache = std::make_unique<ElementCache>();
  for (int n = 0; n < 200; ++n) {
    *cache = {};
    Element element = random_element(random);
    store(*cache, element);
    const PrismPoint at{{0.2, 0.5, 0.3}, kSphereRadiusM - 0.002};
    const Eigen::Vector3d x = position_at(element, at);
    const FieldPlace place = smooth_place(*cache, x);
    constexpr double kStepM = 1e-7;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = kStepM * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d by = (foot_m(smooth_place(*cache, x + step)) -
                                  foot_m(smooth_place(*cache, x - step))) /
                                 (2.0 * kStepM);
      EXPECT_LT((by - foot_turn(place).col(i)).norm(), 1e-6) << n;
    }
    for (ElementNode& node : element.node) {  // over a plane: straight down
      node.position_m[2] = 0.0;
      node.normal = {0.0, 0.0, 1.0};
    }
    *cache = {};
    store(*cache, element);
    const Eigen::Vector3d over = position_at(element, at);
    const Eigen::Vector3d foot = foot_m(smooth_place(*cache, over));
    EXPECT_LT((foot - Eigen::Vector3d(over.x(), over.y(), 0.0)).norm(), 1e-17) << n;
  }
}

// Places near faces and nodes, where some node has no response, or little weight.
TEST(SmoothField, NeverPullsAndStoresNoNegativeEnergy) {
  std::mt19937_64 random(18);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  auto cache = std::make_unique<ElementCache>();
  int sound = 0;
  for (int n = 0; n < 20000; ++n) {
    *cache = {};
    Element element = random_element(random);
    for (ElementNode& node : element.node) {
      if (unit(random) < 0.1) {
        node.samples = 0;
        node.direction = {};
      }
    }
    store(*cache, element);
    PrismPoint at;
    for (int j = 0; j < 3; ++j) {
      at.area(j) = std::pow(10.0, -5.0 * unit(random));
    }
    at.area /= at.area.sum();
    at.height_m = kSphereRadiusM - 0.006 * unit(random);
    const PrismFrame frame = frame_at(make_prism(element), at, Beyond::kAnalytic);
    const FieldPlace place = smooth_place(*cache, frame.position_m);
    const FieldResponse response = response_at(*cache, place);
    EXPECT_GE(response.energy_j, 0.0);
    if (!place.folded && !place.outside) {
      EXPECT_GE(response.force_n.dot(frame.normal), -1e-12) << n;
      ++sound;
    }
  }
  EXPECT_GT(sound, 19000);
}

}  // namespace
}  // namespace palpate
