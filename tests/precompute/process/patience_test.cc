#include "precompute/process/patience.h"

#include <new>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(Patience, TriesAgainUntilTheWantHasPassed) {
  int calls = 0;
  with_patience(60.0, "its press", [&] {
    if (++calls == 1) {
      throw ResourceError("no room");
    }
    if (calls == 2) {
      throw std::bad_alloc();
    }
  });
  EXPECT_EQ(calls, 3);
}

TEST(Patience, EndsWithWhatIsWanting) {
  int calls = 0;
  try {
    with_patience(0.2, "its press", [&] {
      ++calls;
      throw std::bad_alloc();
    });
    FAIL() << "memory came from nowhere";
  } catch (const ResourceError& error) {
    EXPECT_STREQ(error.what(), "its press needed more memory than there is");
    EXPECT_EQ(error.exit_code(), 75);
  }
  EXPECT_GE(calls, 2);
}

TEST(Patience, IsForWantsAlone) {
  int calls = 0;
  EXPECT_THROW(with_patience(60.0, "its press",
                             [&] {
                               ++calls;
                               throw NumericalError("it does not converge");
                             }),
               NumericalError);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace palpate
