#include "formats/tool_shape.h"

#include <cmath>
#include <limits>

#include "formats/error.h"

namespace palpate {
namespace {

const ToolShape kBall{"ball", "sphere", 0.005, 0.3, 0.0005};

std::string error_of(const ToolShape& tool) {
  try {
    check(tool);
  } catch (const InputError& error) {
    return error.what();
  }
  return "good";
}

TEST(ToolShape, AGoodToolPasses) {
  EXPECT_EQ(error_of(kBall), "good");
  EXPECT_EQ(error_of({"ball", "sphere", 0.005, 0.0, 0.0}), "good");
}

TEST(ToolShape, ValuesOutOfRangeAreNamed) {
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  for (const double radius_m : {0.0, -0.1, nan, inf}) {
    EXPECT_NE(error_of({"ball", "sphere", radius_m, 0.0, 0.0}).find("radius_m is"),
              std::string::npos);
  }
  for (const double friction : {-0.1, 10.1, nan, inf}) {
    EXPECT_NE(error_of({"ball", "sphere", 0.1, friction, 0.1}).find("friction is"),
              std::string::npos);
  }
  for (const double presliding_m : {-0.1, nan, inf}) {
    EXPECT_NE(error_of({"ball", "sphere", 0.1, 0.1, presliding_m}).find("presliding_m"),
              std::string::npos);
  }
  EXPECT_EQ(
      error_of({"ball", "sphere", 0.1, 0.1, 0.0}),
      "tool \"ball\": friction 0.1 needs presliding_m > 0, the displacement before "
      "sliding");
}

TEST(ToolShape, AnUnknownShapeIsRefusedWithThoseThatThereAre) {
  EXPECT_EQ(error_of({"ball", "cone", 0.1, 0.0, 0.0}),
            "tool \"ball\": shape \"cone\" is not available; available: sphere");
}

TEST(ToolShape, ANameMustFitAFileAndACommandLine) {
  for (const char* name : {"", "a b", "a/b", ".", "a\nb"}) {
    EXPECT_NE(error_of({name, "sphere", 0.1, 0.0, 0.0}).find("cannot be used"),
              std::string::npos)
        << name;
  }
  EXPECT_NE(
      error_of({std::string(65, 'a'), "sphere", 0.1, 0.0, 0.0}).find("cannot be used"),
      std::string::npos);
  EXPECT_EQ(error_of({"bölli-2.1", "sphere", 0.1, 0.0, 0.0}), "good");
}

}  // namespace
}  // namespace palpate
