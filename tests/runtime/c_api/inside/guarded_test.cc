#include "runtime/c_api/guarded.h"

#include <array>
#include <new>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace {

struct Guarded {
  int error = 0;
  std::string text;
};

template <typename Thrown>
Guarded guarded_throw(const Thrown& thrown) {
  std::array<char, 64> text{};
  const int error = guarded(text.data(), text.size(), [&]() -> int {
    throw thrown;
  });
  return {error, text.data()};
}

TEST(Guarded, ReturnsWhatTheWorkDoesAndSaysNothing) {
  std::array<char, 8> text{"before"};
  EXPECT_EQ(guarded(text.data(), text.size(),
                    [] {
                      return 7;
                    }),
            7);
  EXPECT_STREQ(text.data(), "before");
}

TEST(Guarded, EachKindOfErrorHasItsNumberAndItsText) {
  const Guarded input = guarded_throw(InputError("no such tool"));
  EXPECT_EQ(input.error, PALPATE_ERROR_INPUT);
  EXPECT_EQ(input.text, "no such tool");
  EXPECT_EQ(guarded_throw(FormatError("row 3")).error, PALPATE_ERROR_FORMAT);
  EXPECT_EQ(guarded_throw(FormatError("row 3")).text, "row 3");
  EXPECT_EQ(guarded_throw(NumericalError("nan")).error, PALPATE_ERROR_INTERNAL);
  EXPECT_EQ(guarded_throw(std::runtime_error("bug")).error, PALPATE_ERROR_INTERNAL);
  EXPECT_EQ(guarded_throw(std::runtime_error("bug")).text, "bug");
  EXPECT_EQ(guarded_throw(std::bad_alloc()).error, PALPATE_ERROR_INTERNAL);
  EXPECT_EQ(guarded_throw(42).error, PALPATE_ERROR_INTERNAL);
  EXPECT_EQ(guarded_throw(42).text, "unknown exception");
}

TEST(Guarded, ATextIsCutWithinItsBytesAndEnds) {
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{4}, std::size_t{5},
                                  std::size_t{6}, std::size_t{8}}) {
    std::array<char, 8> text{};
    text.fill('#');
    copy_text("whole", text.data(), bytes);
    EXPECT_EQ(std::string(text.data()), std::string("whole").substr(0, bytes - 1));
    for (std::size_t i = std::min<std::size_t>(bytes, 6); i < text.size(); ++i) {
      EXPECT_EQ(text[i], '#') << bytes;
    }
  }
}

TEST(Guarded, WithoutRoomForATextNothingIsWritten) {
  char kept = '#';
  copy_text("whole", &kept, 0);
  EXPECT_EQ(kept, '#');
  copy_text("whole", nullptr, 8);
  EXPECT_EQ(guarded(nullptr, 8,
                    []() -> int {
                      throw InputError("it");
                    }),
            PALPATE_ERROR_INPUT);
}

}  // namespace
}  // namespace palpate
