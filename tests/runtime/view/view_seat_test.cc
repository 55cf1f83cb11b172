// Where tools begin over a body, and where they are lifted to.
#include "runtime/view/view_seat.h"

#include <gtest/gtest.h>

#include "tests/support/padded_plate.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

TEST(ViewSeat, AToolIsLiftedClearByItsDeepestCurve) {
  const ResponseDatabase database = sample_database(
      plate(0.1, 10), ball(0.005, 0.3, 5e-4),
      [](Eigen::Index, double d) {
        return 100.0 * d;
      },
      0.012);
  const ResponseTable& table = database.tools[0];
  EXPECT_NEAR(clearance_m(table), 0.012, 1e-15);
  EXPECT_TRUE(lifted_m(table, Eigen::Quaterniond::Identity(), {0.01, 0.02, 0.0},
                       Eigen::Vector3d::UnitZ())
                  .isApprox(Eigen::Vector3d(0.01, 0.02, 0.017), 1e-12));
}

TEST(ViewSeat, ASecondHandBeginsBesideTheFirst) {
  const ResponseDatabase database = padded_plate(3);
  const std::vector<const ResponseTable*> tools{&database.tools[0], &database.tools[1]};
  const std::vector<std::int32_t> nodes = nodes_to_begin_over(database, tools);
  ASSERT_EQ(nodes.size(), 2U);
  const double apart_m =
      (database.body.position_m.row(nodes[0]) - database.body.position_m.row(nodes[1]))
          .norm();
  EXPECT_GT(apart_m, tools[0]->tool.radius_m);
  EXPECT_EQ(nodes_to_begin_over(database, {tools[0]}), (std::vector{nodes[0]}));
}

}  // namespace
}  // namespace palpate
