#include "runtime/realtime/deadlines.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Deadlines, DoNotDriftAtARateThatDoesNotDivideASecond) {
  Deadlines deadlines(1000, 3000.0);
  for (std::int64_t k = 0; k <= 3'000'000; ++k) {
    const std::int64_t exact = 1000 + (k * 1'000'000 + 1) / 3;  // k / 3000 s, rounded
    ASSERT_EQ(deadlines.next_ns(), exact) << k;
    ASSERT_EQ(deadlines.begin(deadlines.next_ns()), 0);
  }
}

TEST(Deadlines, CountWhatWasSkippedAndKeepTheirRaster) {
  Deadlines deadlines(0, 1000.0);
  EXPECT_EQ(deadlines.begin(999'999), 0);  // late by less than a period
  EXPECT_EQ(deadlines.next_ns(), 1'000'000);
  EXPECT_EQ(deadlines.begin(4'200'000), 3);  // those at 2, 3 and 4 ms had no work
  EXPECT_EQ(deadlines.next_ns(), 5'000'000);
}

}  // namespace
}  // namespace palpate
