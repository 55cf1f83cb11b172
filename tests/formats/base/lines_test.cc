#include "formats/base/lines.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Lines = std::vector<std::string>;

TEST(Lines, SplitIsWhatWasJoined) {
  for (const Lines& lines :
       {Lines{}, Lines{"ball"}, Lines{"ball", "a tip", "b"}, Lines{"a", "", "b"}}) {
    EXPECT_EQ(split_lines(join_lines(lines)), lines);
  }
  EXPECT_EQ(join_lines({"ball", "a tip"}), "ball\na tip");
}

}  // namespace
}  // namespace palpate
