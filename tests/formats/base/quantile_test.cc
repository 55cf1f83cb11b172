#include "formats/base/quantile.h"

#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Quantile, OfEightTheFifthSmallestIsTheMedian) {
  const std::vector<double> eight{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0};
  EXPECT_EQ(quantile(eight, 0.0), 1.0);
  EXPECT_EQ(quantile(eight, 0.5), 5.0);
  EXPECT_EQ(quantile(eight, 0.95), 8.0);
  EXPECT_EQ(quantile(eight, 1.0), 8.0);
}

TEST(Quantile, OfNoneIsZeroAndOfOneThatOne) {
  EXPECT_EQ(quantile({}, 0.5), 0.0);
  const std::vector<double> one{3.0};
  EXPECT_EQ(quantile(one, 0.0), 3.0);
  EXPECT_EQ(quantile(one, 1.0), 3.0);
}

}  // namespace
}  // namespace palpate
