#include "runtime/view/view_dents.h"

#include <gtest/gtest.h>

#include "formats/database/table_memory.h"
#include "runtime/view/view_session.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

// f = 2e4 d^2 of a sudden press; half of it relaxes within half a second.
ResponseDatabase relaxing_plate() {
  ResponseDatabase database = sample_database(
      plate(0.1, 10), ball(0.005, 0.0, 0.0),
      [](Eigen::Index, double d) {
        return 2e4 * d * d;
      },
      0.01, 41);
  Viscoelasticity relaxation;
  relaxation.instantaneous = true;
  relaxation.tau_s = {0.1};
  relaxation.g = RowsOf<float>{{0.5F}};
  give_memory(database.body, database.normal, relaxation, 1, database.tools[0]);
  return database;
}

TEST(ViewDents, AreAsDeepAsTheForceThatSitesCarry) {
  const ResponseDatabase database = relaxing_plate();
  const ViewDents dents(database.tools[0]);
  // All sites carry the force of 3 mm: so does every node.
  std::vector<SurfaceDent> carried;
  const auto sites = database.tools[0].viscoelasticity.sites.node.size();
  for (std::size_t i = 0; i < sites; ++i) {
    carried.push_back({static_cast<std::int32_t>(i), 2e4 * 0.003 * 0.003});
  }
  const std::vector<NodeDent> nodes = dents.at(carried, 1.0);
  EXPECT_EQ(std::ssize(nodes), database.body.position_m.rows());
  for (const NodeDent& dent : nodes) {
    EXPECT_NEAR(dent.depth_m, 0.003, 1e-5);
  }
  // Four times as stiff, it is the force of half the depth.
  EXPECT_NEAR(dents.at(carried, 4.0).front().depth_m, 0.0015, 1e-5);
  EXPECT_TRUE(dents.at({}, 1.0).empty());
}

TEST(ViewDents, OfASessionAppearUnderTheToolAndGoBack) {
  const ResponseDatabase database = relaxing_plate();
  ViewSession session(database, {});
  session.advance(100);
  EXPECT_TRUE(session.frame().dents.empty());
  session.follow({.hold = true, .target_m = {0.0, 0.0, -0.004}});
  session.advance(4000);
  const double held_n = session.latest().force_n[2];
  EXPECT_GT(held_n, 0.02);
  const auto deepest = [&] {
    double most_m = 0.0;
    const ViewFrame frame = session.frame();
    for (const NodeDent& dent : frame.dents) {
      most_m = std::max(most_m, dent.depth_m);
    }
    return most_m;
  };
  const double dent_m = deepest();
  EXPECT_GT(dent_m, 0.001);
  session.let_go();
  session.advance(400);
  EXPECT_EQ(session.latest().force_n[2], 0.0);
  const double left_m = deepest();
  EXPECT_GT(left_m, 0.0005);
  EXPECT_LT(left_m, dent_m);
  session.advance(6000);
  EXPECT_TRUE(session.frame().dents.empty());
  session.reset();
  EXPECT_TRUE(session.frame().dents.empty());
}

TEST(ViewDents, OfABodyThatYieldsStayAndAreGoneAfterAReset) {
  ResponseDatabase database = relaxing_plate();
  Viscoelasticity yields;
  yields.yielding = {.yield_depth_m = {0.001}, .share = {0.4}};
  give_memory(database.body, database.normal, yields, 1, database.tools[0]);
  ViewSession session(database, {});
  session.follow({.hold = true, .target_m = {0.0, 0.0, -0.006}});
  session.advance(4000);
  session.let_go();
  session.advance(400);
  EXPECT_EQ(session.latest().force_n[2], 0.0);
  const std::vector<NodeDent> dents = session.frame().dents;
  ASSERT_FALSE(dents.empty());
  const auto deepest = std::max_element(dents.begin(), dents.end(),
                                        [](const NodeDent& a, const NodeDent& b) {
                                          return a.depth_m < b.depth_m;
                                        });
  EXPECT_EQ(database.body.position_m.row(deepest->node).norm(), 0.0);
  EXPECT_GT(deepest->depth_m, 0.0005);
  session.advance(20000);
  EXPECT_EQ(session.frame().dents.size(), dents.size());
  // A session of its own begins where this one ended.
  ViewSession next(database, {.surface = session.kept()});
  EXPECT_EQ(next.frame().dents.size(), dents.size());
  next.reset();
  EXPECT_EQ(next.frame().dents.size(), dents.size());
  session.reset();
  EXPECT_TRUE(session.frame().dents.empty());
}

TEST(ViewDents, OfAStaticBodyAreNone) {
  ResponseDatabase database = relaxing_plate();
  database.tools[0].viscoelasticity = {};
  EXPECT_TRUE(ViewDents(database.tools[0]).at({}, 1.0).empty());
}

}  // namespace
}  // namespace palpate
