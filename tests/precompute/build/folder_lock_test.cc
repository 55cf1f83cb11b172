#include "precompute/build/folder_lock.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "tests/support/said.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(FolderLock, IsAlonesOrSharedByThoseWhoShareIt) {
  const ScratchFolder folder;
  const auto refused = [&](FolderUse use) {
    return refusal([&] {
      const FolderLock lock(folder.path(), use);
    });
  };
  {
    const FolderLock alone(folder.path(), FolderUse::kAlone);
    const std::string said = refused(FolderUse::kAlone);
    EXPECT_NE(said.find("process " + std::to_string(getpid())), std::string::npos)
        << said;
    EXPECT_NE(refused(FolderUse::kShared), "");
    EXPECT_THROW(FolderLock(folder.path(), FolderUse::kAlone), ResourceError);
  }
  {
    const FolderLock one(folder.path(), FolderUse::kShared);
    EXPECT_EQ(refused(FolderUse::kShared), "");
    EXPECT_NE(refused(FolderUse::kAlone), "");
  }
  EXPECT_EQ(refused(FolderUse::kAlone), "");
}

TEST(FolderLock, KnowsAnotherFolderOfItsName) {
  const ScratchFolder folder;
  const std::filesystem::path partial = folder / "partial";
  std::filesystem::create_directory(partial);
  const FolderLock lock(partial, FolderUse::kAlone);
  EXPECT_TRUE(lock.is_still_there());
  std::filesystem::remove_all(partial);
  EXPECT_FALSE(lock.is_still_there());
  std::filesystem::create_directory(partial);
  const FolderLock other(partial, FolderUse::kAlone);
  EXPECT_FALSE(lock.is_still_there());
  EXPECT_TRUE(other.is_still_there());
}

}  // namespace
}  // namespace palpate
