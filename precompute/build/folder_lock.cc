#include "precompute/build/folder_lock.h"

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

std::string this_process() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return fmt::format("process {} on {}", getpid(), host.data());
}

std::string owner_of(int lock) {
  std::array<char, 512> text{};
  const ssize_t n = pread(lock, text.data(), text.size() - 1, 0);
  return n > 0 ? std::string(text.data(), static_cast<std::size_t>(n))
               : std::string("another process");
}

void say_owner(int lock) {
  const std::string text = this_process();
  if (ftruncate(lock, 0) != 0 ||
      pwrite(lock, text.data(), text.size(), 0) != std::ssize(text)) {
    return;  // of a full disk; the lock holds all the same
  }
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder, FolderUse use)
    : file_(folder / "lock") {
  const int how = use == FolderUse::kAlone ? LOCK_EX : LOCK_SH;
  while (true) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      const bool gone = errno == ENOENT;  // whoever was here may just have taken it
      std::error_code failed;
      std::filesystem::create_directories(folder, failed);
      if (gone && !failed) {
        continue;
      }
      return;
    }
    const bool locked = flock(descriptor_, how | LOCK_NB) == 0;
    if (!locked && errno == EWOULDBLOCK) {
      const std::string owner = owner_of(descriptor_);
      ::close(descriptor_);
      throw ResourceError(
          fmt::format("{} works on {} already: wait for its end, or write another file",
                      owner, folder.string()));
    }
    if (!locked || is_still_there()) {
      break;
    }
    ::close(descriptor_);
  }
  say_owner(descriptor_);
}

bool FolderLock::is_still_there() const {
  struct stat opened {};
  struct stat there {};
  return descriptor_ >= 0 && fstat(descriptor_, &opened) == 0 &&
         stat(file_.c_str(), &there) == 0 && opened.st_ino == there.st_ino &&
         opened.st_dev == there.st_dev;
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

}  // namespace palpate
