#include "runtime/slow/contact_stiffness.h"

#include <utility>

#include <gtest/gtest.h>

#include "runtime/slow/field_stiffness.h"
#include "tests/support/padded_plate.h"

namespace palpate {
namespace {

constexpr double kSmall = 0.003;

// Spheres of two radii, the small one at -12 mm: one body, whose responses to the small
// one are a quarter as stiff. @param first_small it is listed first, else last.
ResponseDatabase plate_of_two_radii(bool first_small) {
  ResponseDatabase database = padded_plate(3);
  const auto softer = [](Eigen::Index, double d) {
    return 0.25 * 2e4 * d * d;
  };
  ResponseTable own =
      sample_database(plate(0.1, 20), ball(kPadRadius, 0.3, 2e-3), softer, 0.01, 41)
          .tools[0];
  ResponseTable other = database.tools[0];
  const ToolShape pads = database.tools[1].tool;
  if (!first_small) {
    std::swap(own, other);
  }
  own.tool = pads;
  own.compliance = database.tools[1].compliance;
  other.tool.name = "pads.2";
  other.compliance = {};
  auto& [point_m, radius_m] = own.tool.contact;
  for (int i = 0; i < 3; ++i) {
    point_m(i, 0) = 0.012 * (first_small ? i - 1 : 1 - i);
    radius_m[static_cast<std::size_t>(i)] = point_m(i, 0) < -0.01 ? kSmall : kPadRadius;
  }
  database.tools = {std::move(own), std::move(other)};
  return database;
}

ContactStiffness stiffness_in(const ResponseDatabase& database,
                              const ResponseTable& tool) {
  return contact_stiffness(
      PressingTool(tool),
      stiffest_by_contact(database, tool, LocalModel::kPotential, 8.0));
}

double together_n_per_m(bool first_small) {
  const ResponseDatabase database = plate_of_two_radii(first_small);
  return wrench_margin(stiffness_in(database, database.tools[0]), 1.0, 0.0, 0.001, 0.0)
      .stiffness_n_per_m;
}

// One tool, however its spheres are listed.
TEST(ContactStiffness, EachContactIsAsStiffAsItsRadiusIs) {
  const double big_first = together_n_per_m(false);
  EXPECT_NEAR(together_n_per_m(true), big_first, 1e-6 * big_first);
}

// The field between nodes may be stiffer than any curve, and so are contacts on it.
TEST(ContactStiffness, OneContactIsAsStiffAsTheFieldIs) {
  const ResponseDatabase database = padded_plate(1);
  const ContactStiffness one = stiffness_in(database, database.tools[1]);
  ASSERT_EQ(one.n_per_m.size(), 1);
  EXPECT_NEAR(one.n_per_m(0),
              model_stiffness(database, database.tools[1], LocalModel::kPotential, 8.0)
                  .normal_n_per_m,
              1e-9);
}

}  // namespace
}  // namespace palpate
