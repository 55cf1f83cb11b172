#include "precompute/process/packed_bytes.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(PackedBytes, ComeBackInTheirOrder) {
  const std::vector<double> many{1.5, -2.0, 1e300};
  const std::vector<std::int32_t> none;
  const std::int32_t one = 7;
  std::vector<char> bytes;
  append_bytes(bytes, many);
  append_bytes(bytes, none);
  append_bytes(bytes, &one, 1);
  std::span<const char> left = bytes;
  std::vector<double> many_again;
  std::vector<std::int32_t> none_again{1, 2};
  std::int32_t one_again = 0;
  take_bytes(left, many_again);
  take_bytes(left, none_again);
  take_bytes(left, &one_again, 1);
  EXPECT_EQ(many_again, many);
  EXPECT_EQ(none_again, none);
  EXPECT_EQ(one_again, one);
  EXPECT_TRUE(left.empty());
}

TEST(PackedBytes, ThatAreCutShortAreAnError) {
  std::vector<char> bytes;
  append_bytes(bytes, std::vector<double>{1.0, 2.0});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    std::span<const char> left(bytes.data(), size);
    std::vector<double> numbers;
    EXPECT_THROW(take_bytes(left, numbers), NumericalError) << size;
  }
}

}  // namespace
}  // namespace palpate
