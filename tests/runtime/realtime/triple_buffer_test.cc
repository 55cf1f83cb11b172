#include "runtime/realtime/triple_buffer.h"

#include <atomic>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

namespace palpate {
namespace {

struct Pair {
  std::uint64_t number = 0;
  std::uint64_t filler[30] = {};
  std::uint64_t same = 0;
};

TEST(TripleBuffer, HasNothingFreshBeforeTheFirstWrite) {
  TripleBuffer<int> buffer;
  EXPECT_FALSE(buffer.fetch());
  EXPECT_EQ(buffer.latest(), 0);
}

TEST(TripleBuffer, GivesTheLatestValueOnce) {
  TripleBuffer<int> buffer;
  for (int i = 1; i <= 7; ++i) {
    buffer.write(i);
  }
  EXPECT_TRUE(buffer.fetch());
  EXPECT_EQ(buffer.latest(), 7);
  EXPECT_FALSE(buffer.fetch());
  EXPECT_EQ(buffer.latest(), 7);
}

TEST(TripleBuffer, NeverGivesATornOrAnOlderValueBetweenTwoThreads) {
  constexpr std::uint64_t kWrites = 200'000;
  TripleBuffer<Pair> buffer;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kWrites; ++i) {
      buffer.write({.number = i, .same = i});
    }
  });
  std::uint64_t last = 0;
  bool torn = false;
  bool older = false;
  while (last < kWrites) {
    if (buffer.fetch()) {
      const Pair& value = buffer.latest();
      torn = torn || value.number != value.same;
      older = older || value.number <= last;
      last = value.number;
    }
  }
  writer.join();
  EXPECT_FALSE(torn);
  EXPECT_FALSE(older);
}

}  // namespace
}  // namespace palpate
