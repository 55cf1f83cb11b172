#include "formats/base/atomic_file.h"

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

std::ptrdiff_t entries(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder), {});
}

TEST(AtomicFile, AppearsWholeAtCommit) {
  const ScratchFolder folder;
  AtomicFile file(folder / "a");
  write(file.temporary(), "new");
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  file.commit();
  EXPECT_EQ(bytes_of(folder / "a"), "new");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, LeavesNothingBehindWithoutCommit) {
  const ScratchFolder folder;
  write(folder / "a", "old");
  {
    const AtomicFile file(folder / "a");
    write(file.temporary(), "half");
  }
  EXPECT_EQ(bytes_of(folder / "a"), "old");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, WritesExactlyTheseBytes) {
  const ScratchFolder folder;
  AtomicFile file(folder / "a");
  file.write(std::as_bytes(std::span("longer than what comes next", 27)));
  file.write(std::as_bytes(std::span("new\0!", 5)));
  file.commit();
  EXPECT_EQ(bytes_of(folder / "a"), std::string("new\0!", 5));
}

TEST(AtomicFile, AFullDiskIsTheUsersErrorAndLeavesNothing) {
  const ScratchFolder folder;
  // A limit on the size of files stands in for the full disk.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{4096, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  {
    const AtomicFile file(folder / "a");
    EXPECT_THROW(file.write(std::vector<std::byte>(10000)), InputError);
  }
  EXPECT_THROW(write_database(folder / "a.h5", small_database()), InputError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(entries(folder.path()), 0);
}

TEST(AtomicFile, TwoWritersDoNotShareATemporary) {
  const ScratchFolder folder;
  const AtomicFile one(folder / "a");
  const AtomicFile two(folder / "a");
  EXPECT_NE(one.temporary(), two.temporary());
}

TEST(AtomicFile, KeepsASymbolicLinkAndReplacesWhatItPointsAt) {
  const ScratchFolder folder;
  write(folder / "real", "old");
  std::filesystem::create_symlink(folder / "real", folder / "link");
  AtomicFile file(folder / "link");
  write(file.temporary(), "new");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(bytes_of(folder / "real"), "new");
}

TEST(AtomicFile, RefusesAMissingFolderAFolderAndADevice) {
  const ScratchFolder folder;
  EXPECT_THROW(AtomicFile(folder / "no/a"), InputError);
  EXPECT_THROW(AtomicFile(folder.path()), InputError);
  EXPECT_THROW(AtomicFile("/dev/null"), InputError);
  EXPECT_THROW(AtomicFile(""), InputError);
}

}  // namespace
}  // namespace palpate
