// Points attached to a surface, distances along it, and its operator.
#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "fitting/surface/attached_point.h"
#include "fitting/surface/geodesic_distance.h"
#include "fitting/surface/laplace_beltrami.h"
#include "formats/base/error.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

TEST(AttachedPoint, LiesBelowThePointAndAtCornersAndEdgesOutside) {
  const SurfaceMesh mesh = plate(1.0, 4);
  const AttachedPoint inside = closest_surface_point(mesh, {0.13, -0.21, 0.3});
  EXPECT_LT((position_m(mesh, inside) - Eigen::Vector3d(0.13, -0.21, 0.0)).norm(),
            1e-15);
  EXPECT_NEAR(inside.distance_m, 0.3, 1e-15);
  const AttachedPoint edge = closest_surface_point(mesh, {0.13, 0.9, 0.0});
  EXPECT_LT((position_m(mesh, edge) - Eigen::Vector3d(0.13, 0.5, 0.0)).norm(), 1e-15);
  const AttachedPoint corner = closest_surface_point(mesh, {2.0, 0.9, 0.0});
  EXPECT_EQ(mesh.position_m.row(main_vertex(mesh, corner)),
            Eigen::RowVector3d(0.5, 0.5, 0.0));
  EXPECT_THROW((void)closest_surface_point(mesh, {NAN, 0.0, 0.0}), InputError);
}

TEST(SurfaceOperator, IntegratesLinearFunctionsExactly) {
  const SurfaceMesh mesh = plate(0.2, 5);
  const SurfaceOperator op = surface_operator(mesh);
  EXPECT_NEAR(op.mass_m2.sum(), 0.04, 1e-15);
  const Eigen::VectorXd f = 3.0 * mesh.position_m.col(0) - mesh.position_m.col(1);
  EXPECT_NEAR(f.dot(op.stiffness * f), 10.0 * 0.04, 1e-12);  // |grad|^2 times area
  EXPECT_LT((op.stiffness * Eigen::VectorXd::Ones(f.size())).cwiseAbs().maxCoeff(),
            1e-13);
}

// On a sphere x y is an eigenfunction of the Laplacian, eigenvalue 6 / r^2.
TEST(SurfaceOperator, HasTheSpheresSecondEigenvalue) {
  double previous = 1.0;
  for (const int refinements : {1, 2, 3}) {
    const SurfaceMesh mesh = sphere_surface(0.05, refinements);
    const SurfaceOperator op = surface_operator(mesh);
    const Eigen::VectorXd x =
        mesh.position_m.col(0).cwiseProduct(mesh.position_m.col(1));
    const double quotient = x.dot(op.stiffness * x) / x.dot(op.mass_m2.cwiseProduct(x));
    const double error = std::abs(quotient * 0.05 * 0.05 / 6.0 - 1.0);
    EXPECT_LT(error, 0.35 * previous);
    previous = error;
  }
}

TEST(SurfaceOperator, RefusesATriangleWithoutArea) {
  SurfaceMesh mesh = plate(1.0, 2);
  mesh.position_m.row(mesh.triangle(3, 0)) = mesh.position_m.row(mesh.triangle(3, 1));
  EXPECT_THROW((void)surface_operator(mesh), InputError);
}

TEST(GeodesicDistance, IsTheArcOnASphereToFirstOrder) {
  double previous = 1.0;
  for (const int refinements : {2, 3, 4}) {
    const SurfaceMesh mesh = sphere_surface(1.0, refinements);
    const Eigen::Vector3d pole = mesh.position_m.row(0);
    const AttachedPoint source[] = {closest_surface_point(mesh, pole)};
    const Eigen::VectorXd distance = geodesic_distance_m(mesh, source);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < distance.size(); ++i) {
      const double arc =
          std::acos(std::clamp(pole.dot(mesh.position_m.row(i)), -1.0, 1.0));
      worst = std::max(worst, std::abs(distance[i] - arc));
    }
    EXPECT_LT(worst, 0.8 * previous);  // order h log h
    previous = worst;
  }
  EXPECT_LT(previous, 0.05);
}

TEST(GeodesicDistance, IsInfiniteWhereNoSourceReaches) {
  SurfaceMesh mesh = sphere_surface(1.0, 0);
  const SurfaceMesh other = mesh;
  mesh.position_m.conservativeResize(24, Eigen::NoChange);
  mesh.position_m.bottomRows(12) = other.position_m.array() + 5.0;
  mesh.triangle.conservativeResize(40, Eigen::NoChange);
  mesh.triangle.bottomRows(20) = other.triangle.array() + 12;
  const AttachedPoint source[] = {closest_surface_point(mesh, {5.0, 5.0, 6.0})};
  const Eigen::VectorXd distance = geodesic_distance_m(mesh, source);
  EXPECT_TRUE(std::isinf(distance.head(12).minCoeff()));
  EXPECT_TRUE(std::isfinite(distance.tail(12).maxCoeff()));
}

}  // namespace
}  // namespace palpate
