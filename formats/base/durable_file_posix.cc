#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

#include "formats/base/durable_file.h"

namespace palpate {
namespace {

int flush(const std::filesystem::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  const int error = fd < 0 || ::fsync(fd) != 0 ? errno : 0;
  if (fd >= 0) {
    ::close(fd);
  }
  return error;
}

}  // namespace

// Not mkstemp: the file gets the permissions that the user's umask grants.
int create_file(const std::filesystem::path& file) noexcept {
  const int fd = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (fd < 0) {
    return errno;
  }
  ::close(fd);
  return 0;
}

int overwrite_file(const std::filesystem::path& file,
                   std::span<const std::byte> bytes) noexcept {
  const int fd = ::open(file.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  int error = fd < 0 ? errno : 0;
  while (error == 0 && !bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  // Some file systems report a full disk only here.
  if (fd >= 0 && ::close(fd) != 0 && error == 0) {
    error = errno;
  }
  return error;
}

int flush_file(const std::filesystem::path& file) noexcept {
  return flush(file, O_RDONLY);
}

int flush_folder(const std::filesystem::path& folder) noexcept {
  const int error = flush(folder, O_RDONLY | O_DIRECTORY);
  // Some file systems cannot sync a folder; the rename itself is still atomic.
  return error == EINVAL ? 0 : error;
}

bool is_passing(int error) noexcept {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
    case ENOMEM:
    case EMFILE:
    case ENFILE:
    case ESTALE:
    case EIO:
      return true;
    default:
      return false;
  }
}

long process_id() noexcept {
  return ::getpid();
}

}  // namespace palpate
