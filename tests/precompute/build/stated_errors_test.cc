// What a build says of its forces, against what needs no reference: symmetry, and
// solves of what it interpolated.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "formats/response/force_difference.h"
#include "precompute/build/build.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/organ_scene.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr const char* kGel = R"([body]
mesh = "gel.obj"
length_unit = "m"
[[material]]
region = "body"
law = "neo-hookean"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1e-9]]
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.008
[reach]
box_m = [[-1.0, -0.0001, 0.019], [1.0, 1.0, 1.0]]
depth_max_m = 0.004
[accuracy]
force_relative = 0.1
contact_resolution = 2.0
depths = 6
verify = 0
)";

class StatedErrors : public testing::Test {
 protected:
  BuildReport build_of(const std::string& text, bool solve_all) const {
    std::ofstream(folder_ / "scene.toml") << text;
    Progress quiet(nullptr);
    return build(read_scene(folder_ / "scene.toml"),
                 {.output = folder_ / "out.h5",
                  .solve_all = solve_all,
                  .precision = Precision::kFloat64},
                 quiet);
  }
  ScratchFolder folder_;
};

// Nodes of a cylinder of six-fold symmetry with mirrors that are images of one another:
// equal radius, height and angle modulo 60 degrees, either way round.
using SymmetryClass = std::tuple<long, long, long>;
SymmetryClass class_of(const Eigen::Vector3d& p) {
  const double sixth = std::numbers::pi / 3.0;
  const double r = std::hypot(p.x(), p.y());
  double angle =
      r > 1e-9 ? std::fmod(std::atan2(p.y(), p.x()) + 6.0 * sixth, sixth) : 0.0;
  angle = std::min(angle, sixth - angle);
  return {std::lround(1e6 * r), std::lround(1e6 * p.z()), std::lround(1e4 * angle)};
}

// A node's curve with directions in the frame of its place: radial, around, up; images
// by a mirror count angles the other way round.
struct CurveInPlace {
  CurveInPlace(const ResponseDatabase& database, std::int64_t node) {
    const Eigen::Vector3d p = database.body.position_m.row(node).transpose();
    curve = placed_curve(database.tools.front(), node,
                         database.normal.row(node).transpose());
    const double sixth = std::numbers::pi / 3.0;
    const double r = std::hypot(p.x(), p.y());
    const Eigen::Vector3d out = r > 1e-9 ? Eigen::Vector3d(p.x() / r, p.y() / r, 0.0)
                                         : Eigen::Vector3d::UnitX();
    const bool mirrored =
        std::fmod(std::atan2(p.y(), p.x()) + 6.0 * sixth, sixth) > 0.5 * sixth;
    Eigen::Matrix3d axes;
    axes << out, (mirrored ? -1.0 : 1.0) * Eigen::Vector3d::UnitZ().cross(out),
        Eigen::Vector3d::UnitZ();
    const auto turn = [&](Eigen::Vector3d& v) {
      v = axes.transpose() * v;
    };
    turn(curve.direction);
    turn(curve.outward);
    turn(curve.tilt->tilt);
    turn(curve.tilt->by_depth_per_m);
    for (std::size_t k = 0; k + 2 < curve.sample_direction.size(); k += 3) {
      Eigen::Vector3d u(curve.sample_direction.data() + k);
      turn(u);
      direction.insert(direction.end(), u.begin(), u.end());
    }
    curve.sample_direction = direction;
  }
  CurveInPlace(const CurveInPlace&) = delete;
  CurveInPlace& operator=(const CurveInPlace&) = delete;

  std::vector<double> direction;
  PlacedCurve curve;
};

// The audit needs no reference solution: whatever makes images differ is an error.
TEST_F(StatedErrors, ImagesOfOneNodeAgreeWithinThemOrAreFlagged) {
  write_obj(cylinder(0.02, 0.02, 3), folder_ / "gel.obj", "a cylinder");
  const BuildReport report = build_of(kGel, true);
  const ResponseDatabase& database = report.assembly.database;
  const ResponseTable& table = database.tools.front();
  std::map<SymmetryClass, std::vector<std::int64_t>> classes;
  for (std::int64_t v = 0; v < table.nodes(); ++v) {
    if (!table.curve(v).depth_m.empty()) {
      classes[class_of(database.body.position_m.row(v).transpose())].push_back(v);
    }
  }
  int compared = 0;
  int outside = 0;
  int flagged = 0;
  for (const auto& [place, nodes] : classes) {
    // The image whose force at the end is the median.
    std::vector<std::int64_t> order = nodes;
    std::sort(order.begin(), order.end(), [&](std::int64_t a, std::int64_t b) {
      return table.curve(a).force_n.back() < table.curve(b).force_n.back();
    });
    const std::int64_t middle = order[order.size() / 2];
    for (const std::int64_t v : nodes) {
      const auto i = static_cast<std::size_t>(v);
      if ((table.flags[i] & (kNearSingular | kCoarseContact)) != 0) {
        ++flagged;
      } else if (v != middle) {
        ++compared;
        const double off = force_difference(CurveInPlace(database, v).curve,
                                            CurveInPlace(database, middle).curve);
        outside += off > table.error_relative[i] ? 1 : 0;
      }
    }
  }
  std::printf("%d nodes compared with images, %d outside, %d flagged\n", compared,
              outside, flagged);
  EXPECT_EQ(report.assembly.failed + report.assembly.truncated, 0);
  EXPECT_GE(compared, 8);
  EXPECT_LE(outside, compared / 50);
}

// At one resolution, so that nothing but interpolation differs.
TEST_F(StatedErrors, HoldWhereForcesAreInterpolated) {
  write_obj(organ(2), folder_ / "organ.obj", "an organ");
  std::string text = organ_on_table("neo-hookean") + kBallOnTop + "verify = 0\n";
  text.replace(text.find("radius_m = 0.06"), 15, "radius_m = 0.03");
  const BuildReport some = build_of(text, false);
  const BuildReport all = build_of(text, true);
  const ResponseDatabase& database = some.assembly.database;
  const ResponseTable& table = database.tools.front();
  const ResponseTable& solved = all.assembly.database.tools.front();
  int interpolated = 0;
  for (std::int64_t v = 0; v < table.nodes(); ++v) {
    const auto i = static_cast<std::size_t>(v);
    const Eigen::Vector3d outward = database.normal.row(v).transpose();
    if (table.origin[i] == static_cast<std::uint8_t>(ResponseOrigin::kInterpolated)) {
      ++interpolated;
      EXPECT_LE(force_difference(placed_curve(table, v, outward),
                                 placed_curve(solved, v, outward)),
                table.error_relative[i])
          << v;
    } else if (!table.curve(v).depth_m.empty()) {
      EXPECT_EQ(table.curve(v).force_n.back(), solved.curve(v).force_n.back()) << v;
    }
  }
  EXPECT_GT(interpolated, 5);
}

}  // namespace
}  // namespace palpate
