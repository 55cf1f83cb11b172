#include "runtime/slow/memory_elements.h"

#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/runtime/slow/drained_fifo.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

double linear(Eigen::Index /*node*/, double depth_m) {
  return 100.0 * depth_m;
}

ToolState tool_at(const Eigen::Vector3d& position_m) {
  return {.sequence = 1, .position_m = position_m};
}

class ElementStreamOnSphere : public testing::Test {
 protected:
  const ResponseDatabase database_ =
      sample_database(sphere_surface(0.05, 3), ball(0.005, 0.3, 5e-4), linear, 0.01);
  ElementStream stream_{database_, database_.tools[0]};
  std::unique_ptr<ElementFifo> fifo_ = std::make_unique<ElementFifo>();
};

TEST_F(ElementStreamOnSphere, SendsTheNearestElementFirstAndThoseAroundIt) {
  const Eigen::Vector3d p(0.02, 0.03, 0.045);
  EXPECT_GT(stream_.update(tool_at(p), 77, *fifo_), 9U);
  const std::vector<Element> sent = drain(*fifo_);
  ASSERT_GT(sent.size(), 9U);
  EXPECT_TRUE(sent[0].active);
  EXPECT_EQ(sent[0].triangle, stream_.search().nearest(p).triangle);
  std::set<std::int32_t> triangles;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].active, i == 0);
    EXPECT_EQ(sent[i].sequence, i + 1);
    EXPECT_EQ(sent[i].sent_ns, 77);
    triangles.insert(sent[i].triangle);
  }
  EXPECT_EQ(triangles.size(), sent.size());
  for (const std::int32_t neighbour : sent[0].neighbour) {
    EXPECT_TRUE(triangles.contains(neighbour));
  }
}

TEST_F(ElementStreamOnSphere, GivesTheNodesTheirPlaceNormalAndCurve) {
  const Element element = stream_.element(5);
  for (std::size_t j = 0; j < 3; ++j) {
    const ElementNode& node = element.node[j];
    EXPECT_EQ(node.node, database_.body.triangle(5, static_cast<Eigen::Index>(j)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto column = static_cast<Eigen::Index>(axis);
      EXPECT_EQ(node.position_m[axis], database_.body.position_m(node.node, column));
      EXPECT_EQ(node.normal[axis], database_.normal(node.node, column));
    }
    EXPECT_EQ(node.friction, 0.3);
    EXPECT_EQ(node.presliding_m, 5e-4);
    EXPECT_NEAR(node.curve().at(0.0034).force_n, 0.34, 1e-12);
  }
}

TEST_F(ElementStreamOnSphere, CountsWhatDoesNotFitWhileTheFastProcessStallsAndGoesOn) {
  const ToolState tool = tool_at({0.0, 0.0, 0.06});
  std::size_t sent = 0;
  for (int i = 0; i < 100; ++i) {
    sent += stream_.update(tool, i, *fifo_);
  }
  EXPECT_EQ(sent, kElementFifoCapacity);
  EXPECT_GT(fifo_->dropped(), 0U);
  const std::vector<Element> kept = drain(*fifo_);
  EXPECT_TRUE(
      std::is_sorted(kept.begin(), kept.end(), [](const Element& a, const Element& b) {
        return a.sequence < b.sequence;
      }));
  EXPECT_GT(stream_.update(tool, 100, *fifo_), 9U);
  EXPECT_TRUE(drain(*fifo_).front().active);
}

TEST_F(ElementStreamOnSphere, SendsTheWayOutOfAnElementThatTheFastProcessIsStuckIn) {
  ToolState tool = tool_at({0.0, 0.0, 0.052});
  tool.in_contact = true;
  tool.triangle = stream_.search().nearest({0.052, 0.0, 0.0}).triangle;
  stream_.update(tool, 0, *fifo_);
  std::set<std::int32_t> triangles;
  for (const Element& element : drain(*fifo_)) {
    triangles.insert(element.triangle);
  }
  for (Eigen::Index j = 0; j < 3; ++j) {
    EXPECT_TRUE(triangles.contains(stream_.search().neighbours()(tool.triangle, j)));
  }
}

TEST_F(ElementStreamOnSphere, SendsNothingForAPositionThatIsNotFinite) {
  ToolState tool = tool_at({std::nan(""), 0.0, 0.0});
  EXPECT_EQ(stream_.update(tool, 0, *fifo_), 0U);
  tool.in_contact = true;
  tool.triangle = 3;
  EXPECT_EQ(stream_.update(tool, 0, *fifo_), 0U);
}

TEST(ElementStream, GivesZeroForceWhereANodeHasNoResponse) {
  ResponseDatabase database =
      sample_database(plate(0.1, 4), ball(0.005, 0.3, 5e-4), linear, 0.01);
  std::vector<NodeResponse> none(
      static_cast<std::size_t>(database.body.position_m.rows()));
  database.tools[0] = make_table(ball(0.005, 0.3, 5e-4), none);
  const ElementStream stream(database, database.tools[0]);
  for (const ElementNode& node : stream.element(0).node) {
    EXPECT_EQ(node.samples, 0);
    EXPECT_EQ(node.curve().at(0.002).force_n, 0.0);
    EXPECT_EQ(node.direction, (std::array<double, 3>{}));
  }
}

TEST(ElementStream, ThinsLongCurvesOnceAndSaysWhatItCost) {
  const auto wavy = [](Eigen::Index, double d) {
    return 100.0 * d + 0.01 * std::sin(3000.0 * d);
  };
  const ResponseDatabase database =
      sample_database(plate(0.1, 2), ball(0.005, 0.0, 0.0), wavy, 0.01, 400);
  const ElementStream stream(database, database.tools[0]);
  EXPECT_EQ(stream.resample_loss().nodes, 9);
  EXPECT_GT(stream.resample_loss().force_n, 0.0);
  EXPECT_LT(stream.resample_loss().force_relative, 1e-3);
  const CurveView thinned = stream.element(0).node[0].curve();
  EXPECT_NEAR(thinned.at(0.0051).force_n, wavy(0, 0.0051),
              stream.resample_loss().force_n + 1e-6);
}

TEST(ElementStream, ScalesForceSlopeAndEnergyTogether) {
  const ResponseDatabase database =
      sample_database(plate(0.1, 2), ball(0.005, 0.0, 0.0), linear, 0.01);
  const ElementStream whole(database, database.tools[0]);
  const ElementStream half(database, database.tools[0], 0.5);
  const Element a = whole.element(1);
  const Element b = half.element(1);
  const ResponseSample full = a.node[0].curve().at(0.0033);
  const ResponseSample scaled = b.node[0].curve().at(0.0033);
  EXPECT_DOUBLE_EQ(scaled.force_n, 0.5 * full.force_n);
  EXPECT_DOUBLE_EQ(scaled.stiffness_n_per_m, 0.5 * full.stiffness_n_per_m);
  EXPECT_DOUBLE_EQ(scaled.energy_j, 0.5 * full.energy_j);
  EXPECT_THROW(ElementStream(database, database.tools[0], 0.0), InputError);
}

}  // namespace
}  // namespace palpate
