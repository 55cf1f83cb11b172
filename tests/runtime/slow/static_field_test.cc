#include "runtime/slow/static_field.h"

#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/fast/potential_field.h"
#include "tests/support/sphere_database.h"

namespace palpate {
namespace {

// The reference point near the surface: from 2 mm above to 4 mm in it, and some far
// off.
Points places_about(const ResponseDatabase& database, Eigen::Index count) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> aside(-0.01, 0.01);
  std::uniform_real_distribution<double> depth(-0.002, 0.004);
  std::uniform_int_distribution<Eigen::Index> any(0, database.normal.rows() - 1);
  const double radius_m = database.tools.front().tool.radius_m;
  Points place(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index node = any(random);
    place.row(i) = database.body.position_m.row(node) +
                   (radius_m - depth(random)) * database.normal.row(node);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      place(i, axis) += (i % 100 == 0 ? 10.0 : 1.0) * aside(random);
    }
  }
  return place;
}

// As the fast process has it that takes all elements of one update.
Eigen::Vector3d whole_update_n(const ElementStream& stream, const Eigen::Vector3d& x,
                               double radius_m, FieldKind kind) {
  const std::int32_t active = stream.search().nearest(x).triangle;
  const auto cache = std::make_unique<ElementCache>();
  const WantedTriangles wanted = wanted_triangles(stream.search(), active, -1);
  for (std::size_t i = 0; i < wanted.count; ++i) {
    EXPECT_TRUE(store(*cache, stream.element(wanted.triangle[i])));
  }
  FieldPlace place;
  adopt(place, *cache, find(*cache, active), x, kind);
  CurvePieces pieces;
  return respond(place, *cache, radius_m, 0.0, pieces).force_n;
}

TEST(StaticField, IsWhatWholeUpdatesRenderOnAnyNumberOfThreads) {
  const ResponseDatabase database = sphere_database(12, 9);
  const ResponseTable& table = database.tools.front();
  const ElementStream stream(database, table);
  const Points place = places_about(database, 10'000);
  for (const FieldKind kind : {FieldKind::kSmooth, FieldKind::kFacets}) {
    const StaticField field(database, table, kind);
    const Points force = field.force_n(place);
    Eigen::Index pressed = 0;
    for (Eigen::Index i = 0; i < place.rows(); i += 5) {
      const Eigen::Vector3d wanted_n =
          whole_update_n(stream, place.row(i), nominal_height_m(table.tool), kind);
      ASSERT_EQ(force.row(i).transpose(), wanted_n) << i;
      pressed += wanted_n.isZero() ? 0 : 1;
    }
    EXPECT_GT(pressed, 500);
    for (const unsigned threads : {0U, 2U, 5U}) {
      Points again = Points::Constant(place.rows(), 3, -1.0);
      field.force_n(place, again, threads);
      EXPECT_EQ(again, force) << threads;
    }
    Points own = place;
    field.force_n(own, own, 2);
    EXPECT_EQ(own, force);
  }
}

TEST(StaticField, NamesTheFirstPlaceThatIsNotFinite) {
  const ResponseDatabase database = sphere_database(4, 5);
  const StaticField field(database, database.tools.front());
  Points place = places_about(database, 5000);
  place(4321, 1) = std::numeric_limits<double>::infinity();
  place(17, 2) = std::numeric_limits<double>::quiet_NaN();
  try {
    (void)field.force_n(place);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("position 17 is (", 0), 0u)
        << error.what();
  }
  EXPECT_EQ(field.force_n(Points(0, 3)).rows(), 0);
}

}  // namespace
}  // namespace palpate
