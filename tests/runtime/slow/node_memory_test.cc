// What elements carry of a body that relaxes, in memory and streamed.
#include "runtime/slow/node_memory.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/response/memory_sites.h"
#include "formats/response/press_inversion.h"
#include "formats/response/response_curve.h"
#include "formats/response/yielding.h"
#include "runtime/element/element_cache.h"
#include "runtime/slow/file_elements.h"
#include "runtime/slow/memory_elements.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// A sphere in many chunks whose nodes relax differently; curves of a press.
ResponseDatabase relaxing_sphere() {
  ResponseDatabase database = sphere_database(24, 6);
  const auto n = static_cast<std::int64_t>(database.body.position_m.rows());
  Viscoelasticity& relaxation = database.tools[0].viscoelasticity;
  relaxation.tau_s = {0.1, 10.0};
  relaxation.speed_m_per_s = 0.001;
  relaxation.g.resize(n, 2);
  for (std::int64_t i = 0; i < n; ++i) {
    relaxation.g.row(i) << 0.3F * static_cast<float>(i) / static_cast<float>(n), 0.2F;
  }
  relaxation.sites =
      place_sites(database.body, database.normal,
                  std::vector<bool>(static_cast<std::size_t>(n), true), 0.02);
  relaxation.bundle_depth_m = {0.4 * database.tools[0].depth_max_m()};
  database.storage.chunk_nodes = 100;
  return database;
}

void expect_same(const Element& a, const Element& b) {
  EXPECT_EQ(a.memory.yields, b.memory.yields);
  EXPECT_EQ(a.memory.terms, b.memory.terms);
  EXPECT_EQ(a.memory.bundles, b.memory.bundles);
  EXPECT_EQ(a.memory.relaxation_s, b.memory.relaxation_s);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_EQ(a.memory.node[j].site, b.memory.node[j].site);
    EXPECT_EQ(a.memory.node[j].weight, b.memory.node[j].weight);
    EXPECT_EQ(a.memory.node[j].relaxing, b.memory.node[j].relaxing);
    EXPECT_EQ(a.memory.node[j].cut_m, b.memory.node[j].cut_m);
    EXPECT_EQ(a.memory.node[j].yield_depth_m, b.memory.node[j].yield_depth_m);
    EXPECT_EQ(a.memory.node[j].dent_share, b.memory.node[j].dent_share);
    EXPECT_EQ(a.memory.node[j].soft_most, b.memory.node[j].soft_most);
    EXPECT_EQ(a.node[j].force_n, b.node[j].force_n);
    EXPECT_EQ(a.node[j].stiffness_n_per_m, b.node[j].stiffness_n_per_m);
  }
}

TEST(ElementMemoryStream, SendsSharesSitesAndTheInstantaneousCurve) {
  const ResponseDatabase database = relaxing_sphere();
  const ResponseTable& table = database.tools[0];
  const ElementStream stream(database, table, 0.5);
  const Element element = stream.element(17);
  EXPECT_TRUE(well_formed(element.memory));
  EXPECT_EQ(element.memory.terms, 2);
  EXPECT_EQ(element.memory.bundles, 2);
  EXPECT_EQ(element.memory.relaxation_s[1], 10.0);
  for (std::size_t j = 0; j < 3; ++j) {
    const std::int32_t node = element.node[j].node;
    const NodeMemory& memory = element.memory.node[j];
    EXPECT_EQ(memory.relaxing[0],
              static_cast<double>(table.viscoelasticity.g(node, 0)));
    EXPECT_EQ(memory.site[0], table.viscoelasticity.sites.site(node, 0));
    EXPECT_NEAR(memory.weight[0],
                static_cast<double>(table.viscoelasticity.sites.weight(node, 0)), 1e-6);
    const OwnedCurve curve =
        instantaneous_curve(table.curve(node), table.viscoelasticity, node);
    const auto last = static_cast<std::size_t>(element.node[j].samples) - 1;
    EXPECT_EQ(element.node[j].force_n[last], 0.5 * curve.force_n.back());
    EXPECT_GT(curve.force_n.back(), 1.01 * table.curve(node).force_n.back());
  }
}

TEST(ElementMemoryStream, NodesAreSitesWhereThereAreNone) {
  ResponseDatabase database = relaxing_sphere();
  database.tools[0].viscoelasticity.sites = {};
  const ElementStream stream(database, database.tools[0]);
  const Element element = stream.element(3);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_EQ(element.memory.node[j].site[0], element.node[j].node);
    EXPECT_EQ(element.memory.node[j].weight[0], 1.0);
    EXPECT_EQ(element.memory.node[j].site[1], -1);
  }
}

TEST(ElementMemoryStream, SaysHowNodesYieldAndSendsTheUndamagedCurve) {
  ResponseDatabase database = sphere_database(24, 6);
  ResponseTable& table = database.tools[0];
  const auto n = static_cast<std::size_t>(database.body.position_m.rows());
  Yielding& yielding = table.viscoelasticity.yielding;
  yielding = {.yield_depth_m = {0.001},
              .share = std::vector<double>(n, 0.2),
              .onset_m = {0.0},
              .scale_m = {0.003},
              .largest = {0.5}};
  yielding.share[static_cast<std::size_t>(database.body.triangle(17, 1))] = 0.6;
  const ElementStream stream(database, table);
  const Element element = stream.element(17);
  EXPECT_TRUE(well_formed(element.memory));
  EXPECT_TRUE(element.memory.yields);
  EXPECT_EQ(element.memory.terms, 0);
  EXPECT_EQ(element.memory.node[0].dent_share, 0.2);
  EXPECT_EQ(element.memory.node[1].dent_share, 0.6);
  for (std::size_t j = 0; j < 3; ++j) {
    const NodeMemory& memory = element.memory.node[j];
    EXPECT_EQ(memory.yield_depth_m, 0.001);
    EXPECT_EQ(memory.soft_most, 0.5);
    EXPECT_EQ(memory.site[0], element.node[j].node);
    const CurveView curve = table.curve(element.node[j].node);
    const double d = 0.7 * curve.depth_max_m();
    const double left = 1.0 - softened_share(yielding_of(yielding, 0), d);
    EXPECT_NEAR(left * element.node[j].curve().at(d).force_n, curve.at(d).force_n,
                1e-5 * curve.force_n.back());
  }
}

TEST(ElementMemoryStream, OfAStaticBodySaysNothing) {
  const ResponseDatabase database = sphere_database(12, 6);
  const ElementStream stream(database, database.tools[0]);
  EXPECT_EQ(stream.element(3).memory.terms, 0);
  EXPECT_EQ(stream.element(3).memory.node[0].site[0], -1);
}

TEST(ElementMemoryStream, IsTheSameOfAFile) {
  const ScratchFolder folder;
  ResponseDatabase database = relaxing_sphere();
  Yielding& yielding = database.tools[0].viscoelasticity.yielding;
  yielding = {.yield_depth_m = {0.001},
              .share = {},
              .onset_m = {0.001},
              .scale_m = {0.002},
              .largest = {0.3}};
  for (Eigen::Index i = 0; i < database.body.position_m.rows(); ++i) {
    yielding.share.push_back(0.5 / (1.0 + 0.01 * static_cast<double>(i)));
  }
  write_database(folder / "a.h5", database);
  database = read_database(folder / "a.h5");
  ElementStream whole(database, database.tools[0]);
  const Eigen::Vector3d at = 1.01 * database.body.position_m.row(40).transpose();
  StreamedElements streamed(folder / "a.h5", {}, at, false);
  ElementFifo a;
  ElementFifo b;
  const ToolState tool{
      .time_ns = 0, .position_m = at, .triangle = -1, .in_contact = false};
  const std::size_t sent = whole.update(tool, 0, a);
  ASSERT_GT(sent, 5U);
  ASSERT_EQ(streamed.update(tool, 0, b), sent);
  for (; a.front() != nullptr; a.pop(), b.pop()) {
    ASSERT_EQ(a.front()->triangle, b.front()->triangle);
    expect_same(*a.front(), *b.front());
  }
}

ResponseCurve curve_of(const std::vector<double>& force_n) {
  std::vector<double> depth_m;
  for (std::size_t i = 0; i < force_n.size(); ++i) {
    depth_m.push_back(0.001 * static_cast<double>(i));
  }
  return {depth_m, force_n};
}

TEST(BundleCuts, AreWhereAConvexCurveIsAskedToBeCut) {
  const ResponseCurve curve = curve_of({0.0, 0.1, 0.4, 0.9, 1.6, 2.5});
  const auto cuts = bundle_cuts_m(curve.view(), {0.001, 0.0025, 0.004});
  EXPECT_EQ(cuts[0], 0.001);
  EXPECT_EQ(cuts[1], 0.0025);
  EXPECT_EQ(cuts[2], 0.004);
  EXPECT_EQ(cuts[3], 2.0 * 0.005);
}

TEST(BundleCuts, LeaveConcaveStretchesInTheBundleInWhichTheyBegin) {
  // Stiff at first, then soft, then stiff again.
  const ResponseCurve curve = curve_of({0.0, 1.0, 2.0, 2.2, 2.4, 4.0, 6.0});
  const auto cuts = bundle_cuts_m(curve.view(), {0.0005, 0.0015, 0.0035});
  EXPECT_EQ(cuts[0], 0.0035);  // the first two are no cuts: bundles between are empty
  EXPECT_EQ(cuts[1], 0.0035);
  EXPECT_EQ(cuts[2], 0.0035);
}

TEST(BundleCuts, OfAFallingCurveAreNone) {
  const ResponseCurve curve = curve_of({0.0, 1.0, 0.8, 1.4});
  for (const double cut : bundle_cuts_m(curve.view(), {0.0005, 0.0015})) {
    EXPECT_EQ(cut, 2.0 * 0.003);
  }
}

}  // namespace
}  // namespace palpate
