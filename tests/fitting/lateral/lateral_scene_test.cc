#include "fitting/lateral/lateral_scene.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(LateralScene, HasTheKeysOfATool) {
  EXPECT_EQ(lateral_scene({.value = 0.5}, {.value = 2.5e-4}),
            "[[tool]]  # add name, shape and lengths\nfriction = 0.5\n"
            "presliding_m = 0.00025\n");
}

TEST(LateralScene, SaysWhyAKeyIsMissing) {
  const IntervalEstimate none = refused_estimate("of a reason");
  EXPECT_NE(lateral_scene({.value = 0.5}, none).find("# presliding_m: of a reason\n"),
            std::string::npos);
  EXPECT_THROW((void)lateral_scene(none, {.value = 2.5e-4}), InputError);
}

}  // namespace
}  // namespace palpate
