#include <algorithm>
#include <cerrno>
#include <climits>

#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <sys/stat.h>

#include "formats/base/durable_file.h"

namespace palpate {
namespace {

// Closes a descriptor. @returns the error before, or the one of closing
int closed(int fd, int error) {
  return ::_close(fd) != 0 && error == 0 ? errno : error;
}

}  // namespace

int create_file(const std::filesystem::path& file) noexcept {
  const int fd = ::_wopen(file.c_str(), _O_CREAT | _O_EXCL | _O_WRONLY | _O_BINARY,
                          _S_IREAD | _S_IWRITE);
  return fd < 0 ? errno : closed(fd, 0);
}

int overwrite_file(const std::filesystem::path& file,
                   std::span<const std::byte> bytes) noexcept {
  const int fd = ::_wopen(file.c_str(), _O_WRONLY | _O_TRUNC | _O_BINARY);
  if (fd < 0) {
    return errno;
  }
  int error = 0;
  while (error == 0 && !bytes.empty()) {
    const std::size_t most = std::min<std::size_t>(bytes.size(), INT_MAX);
    const int written = ::_write(fd, bytes.data(), static_cast<unsigned>(most));
    error = written < 0 ? errno : 0;
    bytes = bytes.subspan(static_cast<std::size_t>(std::max(written, 0)));
  }
  return closed(fd, error);
}

int flush_file(const std::filesystem::path& file) noexcept {
  const int fd = ::_wopen(file.c_str(), _O_RDWR | _O_BINARY);
  return fd < 0 ? errno : closed(fd, ::_commit(fd) != 0 ? errno : 0);
}

int flush_folder(const std::filesystem::path& /*folder*/) noexcept {
  return 0;
}

bool is_passing(int error) noexcept {
  return error == ENOSPC || error == ENOMEM || error == EMFILE || error == ENFILE ||
         error == EIO;
}

long process_id() noexcept {
  return ::_getpid();
}

}  // namespace palpate
