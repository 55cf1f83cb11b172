#include "precompute/process/parallel.h"

#include <atomic>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Parallel, CallsEachOnce) {
  std::vector<std::atomic<int>> calls(1000);
  in_parallel(calls.size(), [&](std::size_t i) {
    ++calls[i];
  });
  for (const auto& count : calls) {
    EXPECT_EQ(count, 1);
  }
}

TEST(Parallel, ThrowsWhatABodyThrows) {
  EXPECT_THROW(in_parallel(10,
                           [](std::size_t i) {
                             if (i == 3) {
                               throw std::runtime_error("three");
                             }
                           }),
               std::runtime_error);
}

// One outer body throws once the other is inside its loop; that loop must not return
// with a part of its work undone.
TEST(Parallel, AnInnerLoopIsNotCutShortByAnotherOuterBody) {
  const Workers two(2);
  constexpr std::size_t kInner = 200;
  std::atomic<bool> inside = false;
  std::atomic<bool> thrown = false;
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> returned = false;
  EXPECT_THROW(
      in_parallel(2,
                  [&](std::size_t i) {
                    if (i == 1) {
                      while (!inside) {
                        std::this_thread::yield();
                      }
                      thrown = true;
                      throw std::runtime_error("outer");
                    }
                    in_parallel(kInner, [&](std::size_t) {
                      inside = true;
                      while (!thrown) {
                        std::this_thread::yield();
                      }
                      std::this_thread::sleep_for(std::chrono::milliseconds(1));
                      ++done;
                    });
                    returned = true;
                  }),
      std::runtime_error);
  EXPECT_TRUE(returned);
  EXPECT_EQ(done, kInner);
}

}  // namespace
}  // namespace palpate
