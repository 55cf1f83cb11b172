// What the slow and the fast process together do at thin, concave, sharp, crowded and
// touching places.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/fast/fast_step.h"
#include "runtime/slow/memory_elements.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

constexpr double kPathStepM = 5e-5;  // 0.1 m/s
constexpr double kStiffnessNPerM = 500.0;
constexpr double kDepthMaxM = 0.01;
constexpr double kToolRadiusM = 0.003;

double linear(Eigen::Index /*node*/, double d) {
  return kStiffnessNPerM * d;
}

ResponseDatabase body(const SurfaceMesh& mesh, double radius_m = kToolRadiusM) {
  return sample_database(mesh, ball(radius_m, 0.0, 5e-4), linear, kDepthMaxM);
}

// An open surface of that height over a square of 60 mm.
SurfaceMesh surface(int cells,
                    const std::function<double(double x, double y)>& height) {
  SurfaceMesh mesh = plate(0.06, cells);
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    mesh.position_m(v, 2) = height(mesh.position_m(v, 0), mesh.position_m(v, 1));
  }
  return mesh;
}

// A closed plate of that thickness, its upper side at z = 0.
SurfaceMesh sheet(double thickness_m) {
  const SurfaceMesh top = plate(0.06, 12);
  const auto n = static_cast<std::int32_t>(top.position_m.rows());
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  std::vector<Eigen::Vector3i> triangle;
  for (Eigen::Index t = 0; t < top.triangle.rows(); ++t) {
    const Eigen::Vector3i v = top.triangle.row(t).transpose();
    triangle.push_back(v);
    triangle.emplace_back(v(0) + n, v(2) + n, v(1) + n);
    for (int j = 0; j < 3; ++j) {
      ++edges[{v(j), v((j + 1) % 3)}];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto [a, b] = edge;
    if (!edges.contains({b, a})) {
      triangle.emplace_back(b, a, a + n);
      triangle.emplace_back(b, a + n, b + n);
    }
  }
  SurfaceMesh mesh;
  mesh.position_m.resize(2 * Eigen::Index{n}, 3);
  mesh.position_m << top.position_m, top.position_m;
  mesh.position_m.col(2).tail(n).array() -= thickness_m;
  mesh.triangle.resize(static_cast<Eigen::Index>(triangle.size()), 3);
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    mesh.triangle.row(static_cast<Eigen::Index>(t)) = triangle[t].transpose();
  }
  return mesh;
}

// A flat disc of `corners` triangles about one vertex at the origin.
SurfaceMesh fan(int corners, double radius_m) {
  SurfaceMesh mesh;
  mesh.position_m = Points::Zero(corners + 1, 3);
  mesh.triangle.resize(corners, 3);
  for (std::int32_t i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    mesh.position_m.row(i + 1) << radius_m * std::cos(angle),
        radius_m * std::sin(angle), 0.0;
    mesh.triangle.row(i) << 0, i + 1, (i + 1) % corners + 1;
  }
  return mesh;
}

SurfaceMesh both(const SurfaceMesh& a, const SurfaceMesh& b) {
  SurfaceMesh mesh;
  mesh.position_m.resize(a.position_m.rows() + b.position_m.rows(), 3);
  mesh.position_m << a.position_m, b.position_m;
  mesh.triangle.resize(a.triangle.rows() + b.triangle.rows(), 3);
  mesh.triangle << a.triangle,
      (b.triangle.array() + static_cast<std::int32_t>(a.position_m.rows())).matrix();
  return mesh;
}

SurfaceMesh moved(SurfaceMesh mesh, const Eigen::Vector3d& by_m) {
  mesh.position_m.rowwise() += by_m.transpose();
  return mesh;
}

// Both processes at 2 kHz and 100 Hz, on a path of straight lines.
class RenderedPath {
 public:
  RenderedPath(const ResponseDatabase& database, LocalModel model)
      : stream_(database, database.tools[0]) {
    state_->config.model = model;
    state_->config.tool_radius_m = database.tools[0].tool.radius_m;
    state_->config.force_max_n = std::numeric_limits<double>::infinity();
    state_->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  }

  using Look = std::function<void(const Eigen::Vector3d& x, const FastCommand&)>;

  void start(const Eigen::Vector3d& x) {
    x_ = x;
    tick({});
  }

  void go(const Eigen::Vector3d& to, const Look& look = {}) {
    const Eigen::Vector3d from = x_;
    const int steps = static_cast<int>(std::ceil((to - from).norm() / kPathStepM));
    for (int i = 1; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const Eigen::Vector3d x = (1.0 - t) * from + t * to;
      work_j_ += potential_j(*state_, x) - potential_j(*state_, x_);
      x_ = x;
      created_j = std::max(created_j, -work_j_);
      tick(look);
    }
  }

  // Whatever the place: finite, no energy created, no fault.
  void expect_sound(const char* what) const {
    EXPECT_EQ(state_->safety.fault, Fault::kNone) << what;
    EXPECT_TRUE(finite) << what;
    // Some thousand additions of energies below 0.1 J.
    EXPECT_LT(created_j, 1e-12) << what;
    EXPECT_GT(contacts, 100) << what;
  }

  [[nodiscard]] std::int32_t triangle() const { return contact(*state_).triangle; }

  bool starving = false;  ///< the slow process stands still
  bool finite = true;
  double created_j = 0.0;
  double force_max_n = 0.0;
  double jump_max_n = 0.0;  ///< change of force in one tick
  int contacts = 0;

 private:
  void tick(const Look& look) {
    if (tick_ % 20 == 0 && !starving) {
      const FastContact at = contact(*state_);
      const ToolState tool{.sequence = static_cast<std::uint64_t>(tick_ + 1),
                           .time_ns = 0,
                           .position_m = tick_ == 0 ? x_ : at.tool_m,
                           .triangle = at.triangle,
                           .in_contact = at.in_contact};
      (void)stream_.update(tool, 0, *fifo_);
      while (const Element* element = fifo_->front()) {
        accept(*state_, *element);
        fifo_->pop();
      }
    }
    ++tick_;
    const FastCommand command = step(*state_, {x_, 0}, kTickS);
    finite = finite && command.force_n.allFinite();
    contacts += command.in_contact ? 1 : 0;
    force_max_n = std::max(force_max_n, command.force_n.norm());
    jump_max_n = std::max(jump_max_n, (command.force_n - force_n_).norm());
    force_n_ = command.force_n;
    if (look) {
      look(x_, command);
    }
  }

  ElementStream stream_;
  std::unique_ptr<FastState> state_ = std::make_unique<FastState>();
  std::unique_ptr<ElementFifo> fifo_ = std::make_unique<ElementFifo>();
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
  double work_j_ = 0.0;
  int tick_ = 0;
};

class ContactExtremes : public testing::TestWithParam<LocalModel> {};

INSTANTIATE_TEST_SUITE_P(Models, ContactExtremes,
                         testing::Values(LocalModel::kElement, LocalModel::kPotential),
                         [](const auto& model) {
                           return std::string(name(model.param));
                         });

// 8 mm deep into 1 mm: all of a small tool is far out on the other side.
TEST_P(ContactExtremes, NeverPopsThroughASheetOfOneMillimetre) {
  for (const double radius : {0.0, 5e-4, 5e-3}) {
    const ResponseDatabase database = body(sheet(0.001), radius);
    for (const double side : {1.0, -1.0}) {
      const double surface_m = side > 0.0 ? 0.0 : -0.001;
      RenderedPath r(database, GetParam());
      const auto at = [&](double x, double y, double depth) {
        return Eigen::Vector3d(x, y, surface_m + side * (radius - depth));
      };
      const auto look = [&](const Eigen::Vector3d& x, const FastCommand& command) {
        const double depth = radius - side * (x.z() - surface_m);
        // Flat and homogeneous: the curve, to rounding of 5 N, but for picometres that
        // the ledger bleeds back.
        ASSERT_LT(command.rest_offset_m, 1e-10);
        ASSERT_NEAR(
            command.force_n.z(),
            side * kStiffnessNPerM * std::max(0.0, depth - command.rest_offset_m),
            1e-9);
        ASSERT_LT(command.force_n.head<2>().norm(), 1e-9);
        if (depth > 0.0) {
          const auto v = database.body.triangle.row(r.triangle());
          ASSERT_EQ(database.body.position_m(v(0), 2), surface_m);
        }
      };
      r.start(at(0.0031, 0.0017, -0.002));
      r.go(at(0.0031, 0.0017, 0.008), look);
      r.go(at(-0.0152, 0.0113, 0.008), look);
      r.starving = true;
      r.go(at(-0.0141, 0.0117, 0.004), look);
      r.go(at(-0.0152, 0.0113, 0.008), look);
      r.starving = false;
      r.go(at(-0.0152, 0.0113, -0.002), look);
      r.expect_sound("sheet");
    }
  }
}

TEST_P(ContactExtremes, SlidesOffTheRimOfASheetWithoutLosingItsSigns) {
  const ResponseDatabase database = body(sheet(0.001));
  RenderedPath r(database, GetParam());
  r.start({0.02, 0.001, kToolRadiusM + 0.001});
  r.go({0.02, 0.001, kToolRadiusM - 0.002});
  r.go({0.04, 0.001, kToolRadiusM - 0.002});
  r.go({0.02, 0.001, kToolRadiusM - 0.002});
  r.go({0.02, 0.001, kToolRadiusM + 0.002});
  r.expect_sound("rim");
  // 2 mm of depth are 1 N; where the surface turns by 90 degrees within one cell the
  // gradient is longer than the curve's slope.
  EXPECT_LT(r.force_max_n, 4.0);
}

struct Bend {
  const char* name = "";
  double slope = 0.0;  // of z over |x|
  int cells = 12;
};

// Grooves and roofs, crossed in straight lines from flank to flank: under a roof that
// is 10 mm deep in the body, where the field's coordinates fold and its tangential part
// can outweigh the normal one. What holds there is the bound, and the energy.
TEST_P(ContactExtremes, ForceStaysBoundedAndOnThePressedSideAcrossEdges) {
  for (const Bend bend :
       {Bend{"groove of 90 degrees", 1.0}, Bend{"fine groove of 90 degrees", 1.0, 60},
        Bend{"roof of 90 degrees", -1.0}, Bend{"fine roof of 90 degrees", -1.0, 60},
        Bend{"roof of 30 degrees", -3.732}}) {
    const ResponseDatabase database = body(surface(bend.cells, [&](double x, double) {
      return bend.slope * std::abs(x);
    }));
    RenderedPath r(database, GetParam());
    const double lean = 1.0 / std::sqrt(1.0 + bend.slope * bend.slope);
    const auto at = [&](double x, double depth) {  // over the flank of that side
      const double n_x = (x > 0.0 ? -bend.slope : bend.slope) * lean;
      return Eigen::Vector3d(x + (kToolRadiusM - depth) * n_x, 0.0012,
                             bend.slope * std::abs(x) + (kToolRadiusM - depth) * lean);
    };
    r.start(at(0.012, -0.002));
    const auto look = [&](const Eigen::Vector3d& x, const FastCommand& command) {
      const bool in_fold = bend.slope < 0.0 && std::abs(x.x()) < 0.001;
      if (std::abs(x.x()) < 0.01 && !in_fold) {
        ASSERT_GE(command.force_n.z(), -1e-9) << bend.name << " at " << x.transpose();
      }
    };
    r.go(at(0.012, 0.001), look);
    for (int i = 0; i < 3; ++i) {
      r.go(at(-0.012, 0.001), look);
      r.go(at(0.012, 0.001), look);
    }
    r.go(at(0.012, -0.002), look);
    r.expect_sound(bend.name);
    // The curves reach 5 N at 10 mm; gradients across a bend of the surface are longer.
    EXPECT_LT(r.force_max_n, 20.0) << bend.name;
    EXPECT_LT(r.jump_max_n, 20.0) << bend.name;
  }
}

// More triangles than a slow update sends, less than a step across at the apex.
TEST_P(ContactExtremes, RendersTheCurveAroundAVertexOfHighValence) {
  const ResponseDatabase database = body(fan(200, 0.03));
  RenderedPath r(database, GetParam());
  const double depth = 0.002;
  r.start({0.004, 0.001, kToolRadiusM + 0.002});
  r.go({0.004, 0.001, kToolRadiusM - depth});
  const auto look = [&](const Eigen::Vector3d&, const FastCommand& command) {
    ASSERT_NEAR(command.force_n.z(), kStiffnessNPerM * depth, 1e-9);
    ASSERT_LT(command.force_n.head<2>().norm(), 1e-9);
  };
  for (const double radius : {1e-5, 2e-4, 4e-3}) {
    for (int i = 0; i <= 36; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 36.0;
      r.go({radius * std::cos(angle), radius * std::sin(angle), kToolRadiusM - depth},
           look);
    }
  }
  r.go({-0.004, 1e-4, kToolRadiusM - depth}, look);  // over the apex
  r.expect_sound("fan");
}

TEST_P(ContactExtremes, StaysOnTheComponentThatItPressesUntilItIsReleased) {
  constexpr double kBodyM = 0.02;
  const Eigen::Vector3d left(-kBodyM, 0.0, 0.0);
  const Eigen::Vector3d right(kBodyM, 0.0, 0.0);
  const SurfaceMesh sphere = sphere_surface(kBodyM, 3);
  const ResponseDatabase database =
      body(both(moved(sphere, left), moved(sphere, right)));
  RenderedPath r(database, GetParam());
  const auto over = [&](const Eigen::Vector3d& centre, double angle, double depth) {
    const Eigen::Vector3d n(std::sin(angle), 0.0, std::cos(angle));
    return Eigen::Vector3d(centre + (kBodyM + kToolRadiusM - depth) * n);
  };
  const auto pressed = [&](const Eigen::Vector3d& centre) {
    return [&, centre](const Eigen::Vector3d& x, const FastCommand& command) {
      ASSERT_GE(command.force_n.dot(x - centre), -1e-12);
      if (command.in_contact) {
        const auto v = database.body.triangle.row(r.triangle());
        ASSERT_LT((database.body.position_m.row(v(0)).transpose() - centre).norm(),
                  1.001 * kBodyM);
      }
    };
  };
  r.start(over(left, 0.2, -0.002));
  // Along the left sphere, down into the right one at the place where they touch.
  for (double angle = 0.2; angle < 1.5; angle += 0.1) {
    r.go(over(left, angle, 0.001), pressed(left));
  }
  for (double angle = 1.5; angle > 0.2; angle -= 0.1) {
    r.go(over(left, angle, 0.001), pressed(left));
  }
  r.expect_sound("left");
  r.go(over(left, 0.2, -0.002));
  r.go(over(right, -0.2, -0.002));
  for (double angle = -0.2; angle > -1.5; angle -= 0.1) {
    r.go(over(right, angle, 0.001), pressed(right));
  }
  r.expect_sound("right");
  // 1 mm of depth is 0.5 N, chords of an icosphere add less than that of depth.
  EXPECT_LT(r.force_max_n, 1.0);
}

// Flush plates without a common vertex: the plane goes on, and so does the force.
TEST_P(ContactExtremes, GoesOnAcrossTheSeamOfTouchingComponents) {
  const SurfaceMesh half = plate(0.04, 8);
  const ResponseDatabase database =
      body(both(moved(half, {-0.02, 0.0, 0.0}), moved(half, {0.02, 0.0, 0.0})));
  RenderedPath r(database, GetParam());
  const auto look = [&](const Eigen::Vector3d& x, const FastCommand& command) {
    const double depth = std::max(0.0, kToolRadiusM - x.z());
    ASSERT_NEAR(command.force_n.z(), kStiffnessNPerM * depth, 1e-9) << x.transpose();
    ASSERT_LT(command.force_n.head<2>().norm(), 1e-9);
  };
  r.start({-0.01, 0.001, kToolRadiusM + 0.002});
  r.go({-0.01, 0.001, kToolRadiusM - 0.003}, look);
  r.go({0.01, 0.002, kToolRadiusM - 0.003}, look);
  r.go({0.01, 0.002, kToolRadiusM + 0.002}, look);
  r.go({0.01, 0.002, kToolRadiusM - 0.003}, look);
  r.expect_sound("seam");
}

}  // namespace
}  // namespace palpate
