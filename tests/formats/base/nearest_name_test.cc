#include "formats/base/nearest_name.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr std::string_view kKeys[] = {"radius_m", "friction", "presliding_m"};

TEST(NearestName, IsTheOneWithTheFewestEdits) {
  EXPECT_EQ(nearest_name("radius", kKeys), "radius_m");
  EXPECT_EQ(nearest_name("frcition", kKeys), "friction");
  EXPECT_EQ(nearest_name("pre_sliding_mm", kKeys), "presliding_m");
  EXPECT_EQ(nearest_name("friction", kKeys), "friction");
}

TEST(NearestName, ASwapCountsOnceAndTheFirstOfEqualsWins) {
  constexpr std::string_view swaps[] = {"abdd", "acbd"};
  EXPECT_EQ(nearest_name("abcd", swaps), "abdd");
  constexpr std::string_view later[] = {"axxd", "acbd"};
  EXPECT_EQ(nearest_name("abcd", later), "acbd");
}

TEST(NearestName, OfNoCandidatesIsEmpty) {
  EXPECT_EQ(nearest_name("a", {}), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), kKeys), "radius_m");
}

}  // namespace
}  // namespace palpate
