// Weights and height of one element: gradients, agreement with neighbours, exact cases.
#include "runtime/element/smooth_triangle.h"

#include <array>
#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using Eigen::Vector3d;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vector3d vector(double size) {
    return size * Vector3d(in(-1.0, 1.0), in(-1.0, 1.0), in(-1.0, 1.0));
  }
  // Shares of a place inside, each above `least`.
  Vector3d shares(double least) {
    const Vector3d b(in(least, 1.0), in(least, 1.0), in(least, 1.0));
    return b / b.sum();
  }

 private:
  std::mt19937_64 engine_;
};

ElementNode node_at(std::int32_t index, const Vector3d& position,
                    const Vector3d& normal, const Vector3d& tilt,
                    const Vector3d& by_height_per_m = Vector3d::Zero()) {
  ElementNode node;
  node.node = index;
  const Vector3d n = normal.normalized();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    node.position_m[i] = position(row);
    node.normal[i] = n(row);
    node.tilt[i] = tilt(row);
    node.tilt_by_height_per_m[i] = by_height_per_m(row);
  }
  return node;
}

Vector3d along_surface(const Vector3d& v, const Vector3d& normal) {
  const Vector3d n = normal.normalized();
  return v - v.dot(n) * n;
}

// Four nodes around an edge, about 5 mm long, with normals and tilts that differ.
std::array<ElementNode, 4> random_nodes(Random& random) {
  const std::array<Vector3d, 4> corner{
      {{0.0, 0.0, 0.0}, {0.005, 0.0, 0.0}, {0.002, 0.004, 0.0}, {0.003, -0.004, 0.0}}};
  std::array<ElementNode, 4> nodes;
  static Random turning(19);
  for (std::size_t j = 0; j < 4; ++j) {
    const Vector3d n = Vector3d::UnitZ() + random.vector(0.25);
    nodes[j] = node_at(static_cast<std::int32_t>(j), corner[j] + random.vector(5e-4), n,
                       along_surface(random.vector(0.3), n),
                       along_surface(turning.vector(50.0), n));
  }
  return nodes;
}

SmoothTriangle triangle_of(const ElementNode& a, const ElementNode& b,
                           const ElementNode& c) {
  Element element;
  element.touch_height_m = 0.004;
  element.node = {a, b, c};
  return make_smooth_triangle(element);
}

// A place over the element: by its corners' lines.
Vector3d place(const SmoothTriangle& t, const Vector3d& b, double height_m) {
  return t.corner_m * b + height_m * (t.normal * b).normalized();
}

SmoothPoint inside(const SmoothTriangle& t, const Vector3d& x) {
  SmoothPoint point;
  EXPECT_TRUE(set_inside(t, sides_at(t, x), x, point));
  return point;
}

SmoothPoint beyond(const SmoothTriangle& t, const Vector3d& x) {
  SmoothPoint point;
  EXPECT_TRUE(set_beyond(t, sides_at(t, x), x, point));
  return point;
}

// Largest difference of a gradient from central differences, of what a function gives
// for a place: weights in units of 1 / 5 mm.
template <typename Function>
double gradient_error(const Function& at, const Vector3d& x) {
  constexpr double kStepM = 1e-6;
  const SmoothPoint here = at(x);
  double worst = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = kStepM * Vector3d::Unit(i);
    const SmoothPoint more = at(x + step);
    const SmoothPoint less = at(x - step);
    const Vector3d by_weight = (more.weight - less.weight) / (2.0 * kStepM);
    const double by_height = (more.height_m - less.height_m) / (2.0 * kStepM);
    worst = std::max({worst, 0.005 * (by_weight - here.turn.col(i)).norm(),
                      std::abs(by_height - here.rise(i))});
  }
  return worst;
}

TEST(SmoothTriangle, GradientsAreThoseOfDifferences) {
  Random random(3);
  for (int n = 0; n < 500; ++n) {
    const auto nodes = random_nodes(random);
    const SmoothTriangle t = triangle_of(nodes[0], nodes[1], nodes[2]);
    const Vector3d x = place(t, random.shares(0.02), random.in(-0.001, 0.006));
    // Third derivatives are some (1 / size)^3: (1 um / 0.1 mm)^2 near a corner.
    EXPECT_LT(gradient_error(
                  [&](const Vector3d& y) {
                    return inside(t, y);
                  },
                  x),
              1e-4)
        << n;
  }
}

TEST(SmoothTriangle, WeightsAreAPartitionOfOne) {
  Random random(5);
  for (int n = 0; n < 500; ++n) {
    const auto nodes = random_nodes(random);
    const SmoothTriangle t = triangle_of(nodes[0], nodes[1], nodes[2]);
    const SmoothPoint at =
        inside(t, place(t, random.shares(1e-6), random.in(-0.001, 0.006)));
    EXPECT_GE(at.weight.minCoeff(), 0.0);
    EXPECT_NEAR(at.weight.sum(), 1.0, 1e-14);
  }
}

// On the face over an edge, whatever lies on its other sides.
TEST(SmoothTriangle, NeighboursShareValueAndGradientOnTheirFace) {
  Random random(7);
  for (int n = 0; n < 500; ++n) {
    const auto nodes = random_nodes(random);
    const SmoothTriangle one = triangle_of(nodes[0], nodes[1], nodes[2]);
    const SmoothTriangle other = triangle_of(nodes[1], nodes[0], nodes[3]);
    const double t = random.in(0.001, 0.999);
    const double s = random.in(-0.001, 0.006);
    const Vector3d x = (1.0 - t) * (one.corner_m.col(0) + s * one.normal.col(0)) +
                       t * (one.corner_m.col(1) + s * one.normal.col(1));
    const SmoothPoint a = inside(one, x);
    const SmoothPoint b = inside(other, x);
    EXPECT_NEAR(a.height_m, b.height_m, 1e-15) << n;
    EXPECT_LT((a.rise - b.rise).norm(), 1e-11) << n;
    const Vector3d swapped(b.weight(1), b.weight(0), b.weight(2));
    EXPECT_LT((a.weight - swapped).norm(), 1e-12) << n;
    Matrix3 turned = b.turn;
    turned.row(0).swap(turned.row(1));
    EXPECT_LT(0.005 * (a.turn - turned).norm(), 1e-11) << n;
  }
}

TEST(SmoothTriangle, OnANodesLineAllIsTheNodes) {
  Random random(11);
  for (int n = 0; n < 300; ++n) {
    const auto nodes = random_nodes(random);
    const SmoothTriangle t = triangle_of(nodes[0], nodes[1], nodes[2]);
    const int j = n % 3;
    const double s = random.in(-0.001, 0.006);
    for (const double aside : {0.0, 1e-12, 1e-7}) {
      Vector3d b = Vector3d::Constant(0.5 * aside);
      b(j) = 1.0 - aside;
      const SmoothPoint at = inside(t, place(t, b, s));
      // Gradients go to the node's as the way to it.
      EXPECT_NEAR(at.height_m, s, 10.0 * aside * 0.005 + 1e-16);
      const Vector3d rise = t.rise.col(j) + s * t.rise_by_height_per_m.col(j);
      EXPECT_LT((at.rise - rise).norm(), 100.0 * aside + 1e-12);
      EXPECT_LT((at.weight - Vector3d::Unit(j)).norm(), 100.0 * aside * aside + 1e-14);
      EXPECT_LT(0.005 * at.turn.norm(), 100.0 * aside + 1e-12);
    }
  }
}

// Surfaces of equal height over a plane: z = s + q(p) + s r(p), of any quadratics that
// are zero at the corners, so that the nodes' tilts are straight in s.
TEST(SmoothTriangle, InAPlaneQuadraticsThatGrowWithHeightAreExact) {
  Random random(13);
  Random turning(14);
  for (int n = 0; n < 200; ++n) {
    std::array<Eigen::Vector2d, 3> v{{{0.0, 0.0}, {0.005, 0.0}, {0.002, 0.004}}};
    for (auto& corner : v) {
      corner += random.vector(1e-3).head<2>();
    }
    // Of area coordinates, two at a time.
    Eigen::Matrix3d system;
    for (int j = 0; j < 3; ++j) {
      system.col(j) << v[static_cast<std::size_t>(j)], 1.0;
    }
    const Eigen::Matrix3d to_area = system.inverse();
    const auto area = [&](const Eigen::Vector2d& p) -> Vector3d {
      return to_area * Vector3d(p.x(), p.y(), 1.0);
    };
    const auto value = [&](const Vector3d& c, const Eigen::Vector2d& p) {
      const Vector3d b = area(p);
      return c(0) * b(1) * b(2) + c(1) * b(2) * b(0) + c(2) * b(0) * b(1);
    };
    const auto slope = [&](const Vector3d& c, const Eigen::Vector2d& p) -> Vector3d {
      const Vector3d b = area(p);
      const Vector3d by_b(c(1) * b(2) + c(2) * b(1), c(0) * b(2) + c(2) * b(0),
                          c(0) * b(1) + c(1) * b(0));
      const Eigen::Vector2d by_p = to_area.leftCols<2>().transpose() * by_b;
      return {by_p.x(), by_p.y(), 0.0};
    };
    const Vector3d q = random.vector(4e-4);
    const Vector3d r = turning.vector(0.1);
    std::array<ElementNode, 3> nodes;
    for (std::size_t j = 0; j < 3; ++j) {
      nodes[j] = node_at(static_cast<std::int32_t>(j), {v[j].x(), v[j].y(), 0.0},
                         Vector3d::UnitZ(), -slope(q, v[j]), -slope(r, v[j]));
    }
    const SmoothTriangle t = triangle_of(nodes[0], nodes[1], nodes[2]);
    const Vector3d b = random.shares(0.01);
    const Eigen::Vector2d p = b(0) * v[0] + b(1) * v[1] + b(2) * v[2];
    const double z = random.in(-0.001, 0.006);
    const SmoothPoint at = inside(t, {p.x(), p.y(), z});
    const double under = 1.0 + value(r, p);
    const double height_m = (z - value(q, p)) / under;
    EXPECT_NEAR(at.height_m, height_m, 1e-15) << n;
    const Vector3d rise = Vector3d::UnitZ() - slope(q, p) - height_m * slope(r, p);
    EXPECT_LT((at.rise - rise / under).norm(), 1e-10) << n;
  }
}

// Corners on a sphere, rises along its radii: the height is the distance from it, off
// by the fourth power of the edge's length over the radius.
TEST(SmoothTriangle, OnASphereTheHeightIsTheDistance) {
  constexpr double kRadius = 0.04;
  const Vector3d b(0.25, 0.35, 0.4);
  double before = 0.0;
  for (const double size : {0.4, 0.2, 0.1}) {
    std::array<ElementNode, 3> nodes;
    const std::array<Vector3d, 3> aside{
        {{-0.5, -0.4, 0.0}, {0.6, -0.3, 0.0}, {0.1, 0.7, 0.0}}};
    for (std::size_t j = 0; j < 3; ++j) {
      const Vector3d n = (Vector3d::UnitZ() + size * aside[j]).normalized();
      nodes[j] =
          node_at(static_cast<std::int32_t>(j), kRadius * n, n, Vector3d::Zero());
    }
    const SmoothTriangle t = triangle_of(nodes[0], nodes[1], nodes[2]);
    const Vector3d x = place(t, b, 0.01);
    const double error = std::abs(inside(t, x).height_m - (x.norm() - kRadius));
    EXPECT_LT(error, 0.05 * std::pow(size, 4) * kRadius) << size;
    if (before > 0.0) {
      EXPECT_LT(error, before / 13.0) << size;
    }
    before = error;
  }
}

TEST(SmoothTriangle, GoesOnBeyondAnEdgeWithTheSameGradient) {
  Random random(17);
  for (int n = 0; n < 300; ++n) {
    const auto nodes = random_nodes(random);
    const SmoothTriangle t = triangle_of(nodes[0], nodes[1], nodes[2]);
    const double along = random.in(0.05, 0.95);
    const double s = random.in(-0.001, 0.006);
    const Vector3d x = (1.0 - along) * (t.corner_m.col(0) + s * t.normal.col(0)) +
                       along * (t.corner_m.col(1) + s * t.normal.col(1));
    const Vector3d out = -t.edges.across.at(2);
    const SmoothPoint before = inside(t, x - 1e-10 * out);
    const SmoothPoint after = beyond(t, x + 1e-10 * out);
    EXPECT_LT((before.rise - after.rise).norm(), 1e-5) << n;
    EXPECT_LT(0.005 * (before.turn - after.turn).norm(), 1e-5) << n;
    EXPECT_LT(gradient_error(
                  [&](const Vector3d& y) {
                    return beyond(t, y);
                  },
                  x + 0.003 * out),
              1e-5)
        << n;
  }
}

}  // namespace
}  // namespace palpate
