#include "runtime/contacts/coupled_contacts.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// f = a delta^p of every contact, level past `end`, and how often they were asked.
struct PowerLaw {
  ContactValues amplitude = ContactValues::Constant(4.0 / 3.0);
  double exponent = 1.5;
  double end_m = std::numeric_limits<double>::infinity();

  static void evaluate(void* of, CoupledContacts& c, bool energy) {
    const auto& law = *static_cast<const PowerLaw*>(of);
    for (Eigen::Index i = 0; i < c.count; ++i) {
      const double x = std::min(c.delta_m(i), law.end_m);
      const double past = std::max(0.0, c.delta_m(i) - law.end_m);
      const double a = law.amplitude(i);
      const bool pressed = c.delta_m(i) > 0.0;
      const double f = pressed ? a * std::pow(x, law.exponent) : 0.0;
      if (energy) {
        c.own_energy_j(i) = pressed ? f * x / (law.exponent + 1.0) + f * past : 0.0;
        continue;
      }
      c.force_n(i) = f;
      c.stiffness_n_per_m(i) = pressed && past == 0.0 ? law.exponent * f / x : 0.0;
    }
  }
  ContactCurves curves() { return {this, &evaluate}; }
};

using Places = std::vector<Eigen::Vector2d>;

// C of point loads on a half-space with E* = 1: 1 / (pi r).
std::unique_ptr<CoupledContacts> on_half_space(const Places& place) {
  auto c = std::make_unique<CoupledContacts>();
  c->count = static_cast<int>(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    for (std::size_t j = 0; j < place.size(); ++j) {
      if (i != j) {
        c->compliance_m_per_n(static_cast<Eigen::Index>(i),
                              static_cast<Eigen::Index>(j)) =
            1.0 / (std::numbers::pi * (place[i] - place[j]).norm());
      }
    }
  }
  return c;
}

Places square(double side) {
  return {{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}};
}

// ---- boundary elements: frictionless rigid spheres (radius 1) on a half-space, E* = 1

// Displacement by unit pressure on a square of half side b, seen from (x, y), times pi
// (Love 1929).
double love(double x, double y, double b) {
  const auto part = [](double u, double v, double w) {
    return u * std::log((v + std::hypot(u, v)) / (w + std::hypot(u, w)));
  };
  return part(x + b, y + b, y - b) + part(y + b, x + b, x - b) +
         part(x - b, y - b, y + b) + part(y - b, x - b, x + b);
}

// Force on each of equal spheres at the same depth, every one of which is the first
// one's image: `image` mirrors a place relative to the first into that of an image.
struct Image {
  Eigen::Vector2d place;
  Eigen::Vector2d sign;
};

double boundary_elements(double depth, const std::vector<Image>& images) {
  constexpr int kCells = 12;  // per contact radius
  const double h = std::sqrt(depth) / kCells;
  Places cell;
  for (int i = -kCells - 2; i <= kCells + 2; ++i) {
    for (int j = -kCells - 2; j <= kCells + 2; ++j) {
      if (std::hypot(i, j) < kCells + 2) {
        cell.emplace_back(i * h, j * h);
      }
    }
  }
  const auto n = static_cast<Eigen::Index>(cell.size());
  Eigen::MatrixXd influence = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd gap(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d& at = cell[static_cast<std::size_t>(i)];
    gap(i) = depth - 0.5 * at.squaredNorm();
    for (Eigen::Index j = 0; j < n; ++j) {
      for (const Image& image : images) {
        const Eigen::Vector2d r =
            at - image.place -
            image.sign.cwiseProduct(cell[static_cast<std::size_t>(j)]);
        influence(i, j) += love(r.x(), r.y(), 0.5 * h) / std::numbers::pi;
      }
    }
  }
  std::vector<Eigen::Index> on;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (gap(i) > 0.5 * depth) {
      on.push_back(i);
    }
  }
  for (int round = 0; round < 50; ++round) {
    const Eigen::VectorXd p = influence(on, on).ldlt().solve(Eigen::VectorXd(gap(on)));
    std::vector<Eigen::Index> next;
    for (std::size_t i = 0; i < on.size(); ++i) {
      if (p(static_cast<Eigen::Index>(i)) >= 0.0) {
        next.push_back(on[i]);
      }
    }
    if (next.size() == on.size()) {
      const Eigen::VectorXd u = influence(Eigen::all, on) * p;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (gap(i) - u(i) > 1e-12 && std::find(on.begin(), on.end(), i) == on.end()) {
          next.push_back(i);
        }
      }
      if (next.size() == on.size()) {
        return p.sum() * h * h;
      }
    }
    on = next;
  }
  ADD_FAILURE() << "no contact area was found";
  return 0.0;
}

double coupled_force(const Places& place, double depth) {
  const auto c = on_half_space(place);
  c->depth_m.head(c->count).setConstant(depth);
  PowerLaw law;
  EXPECT_TRUE(solve(*c, law.curves()));
  return c->force_n(0);
}

double hertz(double depth) {
  return 4.0 / 3.0 * std::pow(depth, 1.5);
}

// Bounds of the capability: 0.3 % and 0.8 % from two contact radii apart on. What is
// compared is the ratio to a contact alone, by both.
TEST(CoupledContacts, TwoAndFourSpheresAreThoseOfBoundaryElements) {
  constexpr double kDepth = 0.04;
  const double a = std::sqrt(kDepth);
  const double alone = boundary_elements(kDepth, {{{0.0, 0.0}, {1.0, 1.0}}});
  EXPECT_NEAR(alone / hertz(kDepth), 1.0, 2e-3);
  for (const double apart : {2.0, 2.5, 4.0, 10.0}) {
    const double s = apart * a;
    const Image self{{0.0, 0.0}, {1.0, 1.0}};
    const double two =
        boundary_elements(kDepth, {self, {{s, 0.0}, {-1.0, 1.0}}}) / alone;
    const double four = boundary_elements(kDepth, {self,
                                                   {{s, 0.0}, {-1.0, 1.0}},
                                                   {{s, s}, {-1.0, -1.0}},
                                                   {{0.0, s}, {1.0, -1.0}}}) /
                        alone;
    EXPECT_NEAR(coupled_force({{0.0, 0.0}, {s, 0.0}}, kDepth) / hertz(kDepth) / two,
                1.0, 0.003)
        << apart;
    EXPECT_NEAR(coupled_force(square(s), kDepth) / hertz(kDepth) / four, 1.0, 0.008)
        << apart;
    EXPECT_LT(two, 1.0 - 0.4 / apart);  // and it matters
  }
}

TEST(CoupledContacts, OneContactIsItsCurve) {
  const auto c = on_half_space({{0.0, 0.0}});
  PowerLaw law;
  for (const double depth : {-0.01, 0.0, 1e-9, 0.013, 0.4}) {
    c->depth_m(0) = depth;
    ASSERT_TRUE(solve(*c, law.curves()));
    EXPECT_EQ(c->delta_m(0), depth);
    EXPECT_EQ(c->force_n(0), depth > 0.0 ? 4.0 / 3.0 * std::pow(depth, 1.5) : 0.0);
    EXPECT_EQ(c->energy_j, c->own_energy_j(0));
    EXPECT_EQ(c->evaluations, 1);
  }
}

// (1 + 4 a / (3 pi s))^-1.5 at s = 100 a is 0.9937.
TEST(CoupledContacts, FarContactsHardlyFeelEachOther) {
  const double a = 0.2;
  const double ratio =
      coupled_force({{0.0, 0.0}, {100.0 * a, 0.0}}, a * a) / hertz(a * a);
  EXPECT_NEAR(ratio, 1.0, 0.007);
  EXPECT_LT(ratio, 1.0);
}

// Places at least `apart` from each other.
Places scattered(int count, double apart, std::mt19937_64& random) {
  std::uniform_real_distribution<double> where(0.0, 2.0 * apart * std::sqrt(count));
  Places place;
  while (static_cast<int>(place.size()) < count) {
    const Eigen::Vector2d p(where(random), where(random));
    bool free = true;
    for (const Eigen::Vector2d& other : place) {
      free = free && (p - other).norm() > apart;
    }
    if (free) {
      place.push_back(p);
    }
  }
  return place;
}

TEST(CoupledContacts, EquationsHoldForAnyDepths) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-0.4, 1.0);
  PowerLaw law;
  for (const int count : {2, 5, 17, 64}) {
    const auto c = on_half_space(scattered(count, 0.4, random));
    for (int trial = 0; trial < 30; ++trial) {
      for (Eigen::Index i = 0; i < count; ++i) {
        c->depth_m(i) = 0.04 * unit(random);
      }
      ASSERT_TRUE(solve(*c, law.curves()));
      const Eigen::VectorXd f = c->force_n.head(count).matrix();
      const Eigen::VectorXd u = c->compliance_m_per_n.topLeftCorner(count, count) * f;
      EXPECT_GE(f.minCoeff(), 0.0);
      for (Eigen::Index i = 0; i < count; ++i) {
        EXPECT_NEAR(c->delta_m(i) + u(i), c->depth_m(i), 1.1e-12);
        const double delta = std::max(0.0, c->delta_m(i));
        EXPECT_DOUBLE_EQ(f(i), 4.0 / 3.0 * std::pow(delta, 1.5));
      }
    }
  }
}

// Contact that is not reached by what the others leave of it: it carries nothing, and
// the others are as without it.
TEST(CoupledContacts, OthersLiftAContactOff) {
  const Places place{{0.0, 0.0}, {0.5, 0.0}, {0.25, 0.1}};
  const auto c = on_half_space(place);
  PowerLaw law;
  c->depth_m.head(3) << 0.05, 0.05, 0.004;
  ASSERT_TRUE(solve(*c, law.curves()));
  EXPECT_EQ(c->force_n(2), 0.0);
  EXPECT_LT(c->delta_m(2), 0.0);
  const auto pair = on_half_space({place[0], place[1]});
  pair->depth_m.head(2).setConstant(0.05);
  ASSERT_TRUE(solve(*pair, law.curves()));
  EXPECT_NEAR(c->force_n(0), pair->force_n(0), 1e-11);
}

// U is the work of the forces on any way: by Simpson's rule on straight pieces.
TEST(CoupledContacts, EnergyIsTheWorkOfTheForces) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-0.3, 1.0);
  PowerLaw law{.exponent = 2.0};  // smooth enough for Simpson's rule
  for (const int count : {2, 9, 64}) {
    const auto c = on_half_space(scattered(count, 0.4, random));
    Eigen::VectorXd from = Eigen::VectorXd::Constant(count, -0.01);
    double work = 0.0;
    for (int leg = 0; leg < 4; ++leg) {
      Eigen::VectorXd to(count);
      for (double& d : to) {
        d = 0.05 * unit(random);
      }
      constexpr int kSteps = 2000;
      for (int step = 0; step <= kSteps; ++step) {
        const double t = static_cast<double>(step) / kSteps;
        c->depth_m.head(count) = ((1.0 - t) * from + t * to).array();
        ASSERT_TRUE(solve(*c, law.curves()));
        const double weight = step == 0 || step == kSteps ? 1.0 : step % 2 ? 4.0 : 2.0;
        work +=
            weight / (3.0 * kSteps) * c->force_n.head(count).matrix().dot(to - from);
      }
      // Simpson's error at the kinks of f'' where contacts come and go: f'' h^3.
      EXPECT_NEAR(c->energy_j, work, count * 10.0 * std::pow(0.06 / kSteps, 3) + 1e-14);
      from = to;
    }
  }
}

// The gradient by the depths is the force, to the order of the differences.
TEST(CoupledContacts, ForceIsTheSlopeOfTheEnergy) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(0.2, 1.0);
  PowerLaw law;
  const int count = 7;
  const auto c = on_half_space(scattered(count, 0.4, random));
  for (Eigen::Index i = 0; i < count; ++i) {
    c->depth_m(i) = 0.04 * unit(random);
  }
  ASSERT_TRUE(solve(*c, law.curves()));
  const ContactValues force = c->force_n;
  CoupledFactor scratch;
  const double slope = coupled_stiffness_n_per_m(*c, 2, scratch);
  const double h = 1e-6;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double d = c->depth_m(i);
    c->depth_m(i) = d + h;
    ASSERT_TRUE(solve(*c, law.curves()));
    const double above = c->energy_j;
    const double f_above = c->force_n(i);
    c->depth_m(i) = d - h;
    ASSERT_TRUE(solve(*c, law.curves()));
    EXPECT_NEAR((above - c->energy_j) / (2.0 * h), force(i), 1e-9);
    if (i == 2) {
      EXPECT_NEAR((f_above - c->force_n(i)) / (2.0 * h), slope, 1e-6 * slope);
    }
    c->depth_m(i) = d;
  }
}

TEST(CoupledContacts, LevelCurvesCarryTheirForce) {
  const auto c = on_half_space({{0.0, 0.0}, {0.5, 0.0}});
  PowerLaw law{.end_m = 0.02};
  c->depth_m.head(2) << 0.06, 0.01;
  ASSERT_TRUE(solve(*c, law.curves()));
  EXPECT_DOUBLE_EQ(c->force_n(0), hertz(0.02));
  EXPECT_NEAR(c->delta_m(1) + c->dimple_m(1), 0.01, 1e-12);
}

// Two contacts at one place, each of which would sink the other deeper than itself: not
// convex, so less of C counts, and that is said.
TEST(CoupledContacts, OverlappingContactsAreScaledAndSaid) {
  auto c = std::make_unique<CoupledContacts>();
  c->count = 2;
  c->compliance_m_per_n(0, 1) = c->compliance_m_per_n(1, 0) = 3.0;
  c->depth_m.head(2) << 0.3, 0.3;
  PowerLaw law;
  EXPECT_FALSE(solve(*c, law.curves()));
  EXPECT_LT(c->scale, 1.0);
  EXPECT_GT(c->scale, 0.0);
  const double scale = c->scale;
  EXPECT_TRUE(solve(*c, law.curves()));  // and stays so
  EXPECT_EQ(c->scale, scale);
  EXPECT_NEAR(c->delta_m(0) + scale * 3.0 * c->force_n(1), 0.3, 1.1e-12);
}

TEST(CoupledContacts, ASideBySideSlopeOfOneOverCIsNotConvex) {
  // k = 1 / C: the matrix of two punches that are one.
  auto c = std::make_unique<CoupledContacts>();
  c->count = 2;
  PowerLaw law{.amplitude = ContactValues::Constant(1.0), .exponent = 1.0};
  c->compliance_m_per_n(0, 1) = c->compliance_m_per_n(1, 0) = 1.0;
  c->depth_m.head(2) << 0.01, 0.01;
  EXPECT_FALSE(solve(*c, law.curves()));
  EXPECT_EQ(c->scale, 0.5);
}

TEST(CoupledContacts, NumbersThatAreNoneEndAndAreSeen) {
  const auto c = on_half_space(square(0.5));
  PowerLaw law;
  for (const double odd : {kNan, std::numeric_limits<double>::infinity(), -kNan}) {
    c->depth_m.head(4) << 0.01, odd, 0.02, 0.01;
    (void)solve(*c, law.curves());
    EXPECT_FALSE(std::isfinite(c->energy_j));
    EXPECT_EQ(c->scale, 1.0);
    c->depth_m.head(4).setConstant(0.01);
    EXPECT_TRUE(solve(*c, law.curves()));
    EXPECT_TRUE(std::isfinite(c->energy_j));
    EXPECT_NEAR(c->force_n(0), coupled_force(square(0.5), 0.01), 1e-10);
  }
  c->compliance_m_per_n(0, 1) = c->compliance_m_per_n(1, 0) = kNan;
  EXPECT_FALSE(solve(*c, law.curves()));  // C is left out
  EXPECT_EQ(c->scale, 0.0);
  EXPECT_TRUE(std::isfinite(c->energy_j));
}

// A tool that comes down on 64 places and wanders: bounded work, and mostly one old
// factor.
TEST(CoupledContacts, AWarmStartNeedsFewEvaluations) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  PowerLaw law;
  const int count = 64;
  const auto c = on_half_space(scattered(count, 0.4, random));
  Eigen::ArrayXd d = Eigen::ArrayXd::Constant(count, 0.02);
  int evaluations = 0;
  int factorings = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    for (double& one : d) {
      one += 5e-6 * normal(random);
    }
    d += 2e-5 * std::sin(0.01 * tick);
    c->depth_m.head(count) = d;
    ASSERT_TRUE(solve(*c, law.curves()));
    evaluations += c->evaluations;
    factorings += c->factorings;
    ASSERT_LE(c->evaluations, kCoupledEvaluationsMax);
  }
  EXPECT_LT(evaluations, 8 * 2000);
  EXPECT_LT(factorings, 500);
}

}  // namespace
}  // namespace palpate
