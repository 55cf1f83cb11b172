#include "formats/base/believed_bytes.h"

#include <fstream>
#include <string>
#include <system_error>

#include <gtest/gtest.h>

#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(BelievedBytes, OfAFileThatWasWrittenAreItsSize) {
  const ScratchFolder folder;
  std::ofstream(folder / "a", std::ios::binary) << std::string(12345, 'x');
  EXPECT_EQ(believed_bytes(folder / "a"), 12345U);
  EXPECT_EQ(believed_bytes(folder / "none"), 0U);
}

TEST(BelievedBytes, OfAFileWithHolesAreAGibibyteAtMost) {
  const ScratchFolder folder;
  std::ofstream(folder / "a", std::ios::binary) << "x";
  std::error_code error;
  std::filesystem::resize_file(folder / "a", std::uintmax_t{1} << 42, error);
  if (error) {
    GTEST_SKIP() << "no such files here: " << error.message();
  }
  EXPECT_EQ(believed_bytes(folder / "a"), std::uintmax_t{1} << 30);
  std::filesystem::resize_file(folder / "a", std::uintmax_t{1} << 20, error);
  EXPECT_EQ(believed_bytes(folder / "a"), std::uintmax_t{1} << 20);
}

}  // namespace
}  // namespace palpate
