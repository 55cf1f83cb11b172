// What several contacts leave on a body that relaxes and yields, as the page has it.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "formats/database/table_memory.h"
#include "runtime/view/steered_contacts.h"
#include "runtime/view/view_session.h"
#include "tests/support/padded_plate.h"

namespace palpate {
namespace {

// Pads that are lifted leave dents of both kinds, which a reset takes away.
TEST(ContactDents, OfAllPadsAreShown) {
  ResponseDatabase database = padded_plate(2);
  for (ResponseTable& table : database.tools) {
    Viscoelasticity relaxation;
    relaxation.instantaneous = true;
    relaxation.tau_s = {0.1, 2.0};
    relaxation.g = RowsOf<float>{{0.3F, 0.25F}};
    relaxation.yielding.yield_depth_m = {0.0005};
    relaxation.yielding.share = {0.3};
    give_memory(database.body, database.normal, relaxation, 1, table);
  }
  const double side_m = 0.012;  // between pads
  ViewSessionOptions options;
  options.tools = {"pads"};
  ViewSession session(database, options);
  EXPECT_TRUE(session.frame().dents.empty());
  session.follow({.hold = true, .target_m = {0.0, 0.0, 0.002}, .hand = 0});
  session.advance(4000);
  EXPECT_GT(session.report().carried_max_n, 0.0);
  session.let_go();
  session.advance(1000);
  EXPECT_FALSE(session.touching());
  const std::vector<NodeDent> dents = session.frame().dents;
  const auto below = [&](double x_m) {
    return std::count_if(dents.begin(), dents.end(), [&](const NodeDent& dent) {
      const Eigen::Vector3d at = database.body.position_m.row(dent.node).transpose();
      return std::abs(at.x() - x_m) < 0.006 && dent.depth_m > 1e-4;
    });
  };
  EXPECT_GT(below(-0.5 * side_m), 0);
  EXPECT_GT(below(0.5 * side_m), 0);
  EXPECT_GT(session.report().yielded_j, 0.0);
  EXPECT_EQ(session.fault(), Fault::kNone);
  const PassivityLedger& account =
      account_of(dynamic_cast<SteeredContacts&>(session.body()).state());
  EXPECT_GE(account.work_j, -1e-12);
  EXPECT_NEAR(imbalance_j(account), 0.0, 1e-12);
  session.reset();
  EXPECT_TRUE(session.frame().dents.empty());
}

}  // namespace
}  // namespace palpate
