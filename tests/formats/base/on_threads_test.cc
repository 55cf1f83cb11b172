#include "formats/base/on_threads.h"

#include <atomic>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(OnThreads, CallsEachIndexOnce) {
  for (const unsigned threads : {0U, 1U, 3U, 8U}) {
    std::vector<std::atomic<int>> calls(100);
    on_threads(threads, calls.size(), [&](std::size_t i) {
      ++calls[i];
    });
    for (const std::atomic<int>& count : calls) {
      EXPECT_EQ(count, 1) << threads;
    }
  }
  on_threads(4, 0, [](std::size_t) {
    ADD_FAILURE();
  });
}

TEST(OnThreads, WorksSideBySide) {
  std::atomic<int> here{0};
  on_threads(2, 2, [&](std::size_t) {  // each waits for the other
    ++here;
    while (here < 2) {
      std::this_thread::yield();
    }
  });
  EXPECT_EQ(here, 2);
}

TEST(OnThreads, OneThreadIsTheCallers) {
  std::set<std::thread::id> seen;
  on_threads(1, 5, [&](std::size_t) {
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(seen, std::set{std::this_thread::get_id()});
}

TEST(OnThreads, AnExceptionEndsTheLoop) {
  std::atomic<std::size_t> begun{0};
  EXPECT_THROW(on_threads(3, 1'000'000,
                          [&](std::size_t i) {
                            ++begun;
                            if (i == 10) {
                              throw InputError("index 10 is wrong");
                            }
                          }),
               InputError);
  EXPECT_LT(begun, 1'000'000U);
}

}  // namespace
}  // namespace palpate
