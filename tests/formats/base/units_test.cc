#include "formats/base/units.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(Units, LengthsAreExactInMetres) {
  EXPECT_EQ(metres_per("m"), 1.0);
  EXPECT_EQ(metres_per("cm"), 0.01);
  EXPECT_EQ(metres_per("mm"), 0.001);
  EXPECT_EQ(metres_per("in"), 0.0254);
  EXPECT_EQ(metres_per("um"), metres_per("µm"));
}

TEST(Units, ForcesAreExactInNewtons) {
  EXPECT_EQ(newtons_per("mN"), 0.001);
  EXPECT_EQ(newtons_per("kgf"), 9.80665);
  EXPECT_DOUBLE_EQ(newtons_per("gf") * 1000.0, newtons_per("kgf"));
}

TEST(Units, TakesTheUnitsOfTestingMachines) {
  EXPECT_EQ(newtons_per("kN"), 1000.0);
  EXPECT_EQ(newtons_per("pN"), 1e-12);
  EXPECT_DOUBLE_EQ(newtons_per("lbf"), 4.4482216152605);
  EXPECT_EQ(seconds_per("min"), 60.0);
  for (const char* second : {"s", "S", "sec", "Sec", "SEC"}) {
    EXPECT_EQ(seconds_per(second), 1.0);
  }
  EXPECT_EQ(seconds_per("MS"), 1e-3);  // no time unit is another's capital
  EXPECT_EQ(metres_per("\u03bcm"), metres_per("\u00b5m"));
  EXPECT_THROW((void)newtons_per("g"), InputError);  // a mass
  EXPECT_THROW((void)newtons_per("KN"), InputError);
}

TEST(Units, AnUnknownUnitIsNamedWithTheKnownOnes) {
  try {
    (void)metres_per("furlong");
    FAIL() << "knew the furlong";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "unknown length unit \"furlong\"; known: m, dm, cm, mm, um, µm, nm, in");
  }
  EXPECT_THROW((void)newtons_per("n"), InputError);
  EXPECT_THROW((void)newtons_per(""), InputError);
}

}  // namespace
}  // namespace palpate
