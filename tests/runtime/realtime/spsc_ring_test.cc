#include "runtime/realtime/spsc_ring.h"

#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Wide enough that a torn copy would show.
struct Message {
  std::uint64_t number = 0;
  std::uint64_t check[31] = {};
};

Message message(std::uint64_t number) {
  Message m{.number = number};
  for (auto& word : m.check) {
    word = ~number;
  }
  return m;
}

bool whole(const Message& m) {
  for (const auto word : m.check) {
    if (word != ~m.number) {
      return false;
    }
  }
  return true;
}

TEST(SpscRing, GivesValuesInTheOrderTheyCame) {
  SpscRing<int, 4> ring;
  EXPECT_EQ(ring.front(), nullptr);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(ring.push(i));
    ASSERT_TRUE(ring.push(i + 100));
    EXPECT_EQ(*ring.front(), i);
    ring.pop();
    EXPECT_EQ(*ring.front(), i + 100);
    ring.pop();
  }
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(SpscRing, DropsTheNewestAndCountsWhenFull) {
  SpscRing<int, 4> ring;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.push(i));
  }
  EXPECT_FALSE(ring.push(4));
  EXPECT_FALSE(ring.push(5));
  EXPECT_EQ(ring.dropped(), 2U);
  EXPECT_EQ(*ring.front(), 0);
  ring.pop();
  EXPECT_TRUE(ring.push(6));
  for (const int expected : {1, 2, 3, 6}) {
    EXPECT_EQ(*ring.front(), expected);
    ring.pop();
  }
}

TEST(SpscRing, KeepsEveryMessageWholeAndInOrderBetweenTwoThreads) {
  constexpr std::uint64_t kMessages = 100'000;
  SpscRing<Message, 16> ring;
  std::uint64_t refused = 0;
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= kMessages; ++i) {
      while (!ring.push(message(i))) {
        ++refused;
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t expected = 1;
  bool all_whole = true;
  bool in_order = true;
  while (expected <= kMessages) {
    if (const Message* m = ring.front()) {
      all_whole = all_whole && whole(*m);
      in_order = in_order && m->number == expected;
      ring.pop();
      ++expected;
    } else {
      std::this_thread::yield();
    }
  }
  producer.join();
  EXPECT_TRUE(all_whole);
  EXPECT_TRUE(in_order);
  EXPECT_EQ(ring.dropped(), refused);
}

}  // namespace
}  // namespace palpate
