#include "runtime/run/pressed_place.h"

#include <atomic>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/run/render_run.h"
#include "runtime/run/run_outcome.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

// Two triangles over the square from (0, 0, 0) to (2, 1, 0) mm.
SurfaceMesh two_triangles() {
  SurfaceMesh mesh;
  mesh.position_m.resize(4, 3);
  mesh.position_m << 0.0, 0.0, 0.0, 2e-3, 0.0, 0.0, 2e-3, 1e-3, 0.0, 0.0, 1e-3, 0.0;
  mesh.triangle.resize(2, 3);
  mesh.triangle << 0, 1, 2, 0, 2, 3;
  return mesh;
}

TEST(PressedPlace, SaysHowFarTheNodeIs) {
  const PressedPlace place =
      pressed_place(two_triangles(), 3, 17, Eigen::Vector3d(0.0, 1e-3, 1.5e-3));
  EXPECT_EQ(describe(place),
            "node 17 at (0, 0.001, 0) m, 1.5 mm from the place asked for");
  EXPECT_DOUBLE_EQ(place.edge_m, 2e-3);  // of its one triangle, to node 2
  EXPECT_FALSE(place.is_far());
  EXPECT_EQ(far_note(place), "");
}

TEST(PressedPlace, IsFarBeyondAnEdge) {
  const PressedPlace place =
      pressed_place(two_triangles(), 3, 17, Eigen::Vector3d(0.0, 1e-3, 2.1e-3));
  EXPECT_TRUE(place.is_far());
  EXPECT_NE(far_note(place).find("2.1 mm from node 17"), std::string::npos);
  const PressedPlace anywhere = pressed_place(two_triangles(), 3, 17, std::nullopt);
  EXPECT_FALSE(anywhere.is_far());
  EXPECT_EQ(describe(anywhere), "node 17 at (0, 0.001, 0) m");
}

TEST(PressedPlace, StandsInTheReport) {
  const ResponseDatabase database = sample_database(
      sphere_surface(0.04, 3), ball(0.005, 0.3, 5e-4),
      [](Eigen::Index, double d) {
        return 100.0 * d;
      },
      0.005);
  SimulationOptions options;
  options.duration_s = 0.2;
  options.limit_stiffness = true;
  options.at_m = Eigen::Vector3d(0.0, 0.0, 0.0);  // the sphere's middle
  const std::atomic<bool> stop = false;
  const SimulationReport report = simulate(database, options, stop);
  ASSERT_TRUE(report.place.off_m);
  EXPECT_EQ(report.place.node, report.node);
  EXPECT_NEAR(*report.place.off_m, report.place.position_m.norm(), 1e-15);
  EXPECT_NE(summary(report).find("from the place asked for"), std::string::npos);
  EXPECT_NE(summary(report).find("--at takes metres"), std::string::npos);
  EXPECT_DOUBLE_EQ(as_json(report).at("place").at("off_m").get<double>(),
                   *report.place.off_m);
  options.at_m = report.place.position_m;
  const SimulationReport on = simulate(database, options, stop);
  EXPECT_EQ(on.node, report.node);
  EXPECT_EQ(summary(on).find("--at takes metres"), std::string::npos);
}

}  // namespace
}  // namespace palpate
