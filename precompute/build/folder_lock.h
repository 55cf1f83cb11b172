// One process at a time in a folder, or several that know of each other.
#pragma once

#include <filesystem>

namespace palpate {

enum class FolderUse {
  kAlone,   ///< nobody else
  kShared,  ///< with others who share it
};

/// A lock of the kernel's (flock) on "FOLDER/lock", which says who has it. It ends with
/// the process, however that ends. Where a file system has no locks, everybody gets it.
class FolderLock {
 public:
  /// @param folder is there.
  /// @throws ResourceError naming host and process if somebody else is in the folder.
  FolderLock(const std::filesystem::path& folder, FolderUse use);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Whether the folder is still the one that was locked, not a new one of its name.
  [[nodiscard]] bool is_still_there() const;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace palpate
