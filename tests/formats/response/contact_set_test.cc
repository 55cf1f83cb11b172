// Tools that touch by several spheres: radii, names of their tables, what is refused.
#include "formats/response/contact_set.h"

#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

ToolShape three_pads() {
  ToolShape tool{.name = "probe", .radius_m = 0.003};
  tool.contact.point_m = Points(3, 3);
  tool.contact.point_m << 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01, 0.0;
  tool.contact.radius_m = {0.003, 0.002, 0.003};
  return tool;
}

TEST(ContactSet, HasATableForEachRadius) {
  const ToolShape tool = three_pads();
  check(tool);
  EXPECT_EQ(distinct_radii(tool.contact), (std::vector{0.003, 0.002}));
  EXPECT_EQ(radius_of_contacts(tool.contact), (std::vector<std::size_t>{0, 1, 0}));
  const std::vector<ToolShape> spheres = spheres_of(tool);
  ASSERT_EQ(spheres.size(), 2U);
  EXPECT_EQ(spheres[0].name, "probe");
  EXPECT_EQ(spheres[0].contact.radius_m.size(), 3U);
  EXPECT_EQ(spheres[1].name, "probe.2");
  EXPECT_EQ(spheres[1].radius_m, 0.002);
  EXPECT_TRUE(spheres[1].contact.empty());
  check(spheres[1]);
}

TEST(ContactSet, ASphereAloneIsItsOwn) {
  EXPECT_EQ(spheres_of({.name = "ball", .radius_m = 0.003}).size(), 1U);
}

TEST(ContactSet, IsDescribed) {
  EXPECT_EQ(describe(three_pads()), "sphere of radius 3 mm, 3 contacts");
}

void expect_refused(const ToolShape& tool, const std::string& why) {
  try {
    check(tool);
    FAIL() << "was accepted: " << why;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
}

TEST(ContactSet, RefusesWhatCannotTouch) {
  ToolShape tool = three_pads();
  tool.contact.radius_m.pop_back();
  expect_refused(tool, "has 3 centres and 2 radii");
  tool = three_pads();
  tool.contact.radius_m[1] = -1.0;
  expect_refused(tool, "radius_m of a contact sphere is -1");
  tool = three_pads();
  tool.contact.point_m(1, 2) = std::numeric_limits<double>::quiet_NaN();
  expect_refused(tool, "centre of contact sphere 1 is not finite");
  tool = three_pads();
  tool.contact.point_m.row(2) = tool.contact.point_m.row(0);
  expect_refused(tool, "contact spheres 0 and 2 have one centre");
  tool = three_pads();
  tool.radius_m = 0.002;
  expect_refused(tool, "must be that of its first contact sphere: 0.003");
  tool = three_pads();
  tool.kind = "capsule";
  tool.length_m = 0.01;
  expect_refused(tool, "a capsule has no contact spheres");
  tool = three_pads();
  tool.contact.point_m = Points::Random(65, 3);
  tool.contact.radius_m.assign(65, 0.003);
  expect_refused(tool, "1 to 64");
}

}  // namespace
}  // namespace palpate
