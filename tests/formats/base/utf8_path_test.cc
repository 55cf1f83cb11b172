#include "formats/base/utf8_path.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(Utf8Path, ANameIsTheSystemsAndComesBack) {
  const std::string name = "Leber \u00fc \u809d \U0001fac0.h5";
  EXPECT_EQ(utf8_of(path_of_utf8(name)), name);
  EXPECT_EQ(path_of_utf8(name), std::filesystem::path(u8"Leber ü 肝 🫀.h5"));
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "names";
  std::filesystem::create_directory(folder);
  std::ofstream(folder / path_of_utf8(name)) << "a file";
  const std::filesystem::directory_iterator found(folder);
  EXPECT_EQ(utf8_of(found->path().filename()), name);
}

#if !defined(_WIN32)
TEST(Utf8Path, AnyBytesAreANameOnPosix) {
  const std::string latin = "Leber \xfc.h5";
  EXPECT_EQ(utf8_of(path_of_utf8(latin)), latin);
  EXPECT_EQ(path_of_utf8(latin).native(), latin);
}
#endif

}  // namespace
}  // namespace palpate
