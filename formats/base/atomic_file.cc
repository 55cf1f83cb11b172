#include "formats/base/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// What passes by itself, or once somebody has made room.
bool is_passing(int error) {
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

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

void sync(const fs::path& path, int flags, const fs::path& target) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0 || ::fsync(fd) != 0) {
    const int error = errno;
    if (fd >= 0) {
      ::close(fd);
    }
    // Some file systems cannot sync a folder; the rename itself is still atomic.
    if (error == EINVAL && (flags & O_DIRECTORY) != 0) {
      return;
    }
    cannot_be(target, "made durable", error);
  }
  ::close(fd);
}

}  // namespace

void cannot_be(const fs::path& file, const char* what, int error) {
  const std::string text =
      fmt::format("{}: cannot be {}: {}", file.string(), what, std::strerror(error));
  if (is_passing(error)) {
    throw ResourceError(text);
  }
  throw InputError(text);
}

AtomicFile::AtomicFile(const fs::path& target) : target_(target) {
  std::error_code ignored;
  if (fs::is_symlink(target_, ignored)) {  // write what the link points at, keep it
    target_ = fs::weakly_canonical(target_, ignored);
  }
  const fs::file_status status = fs::status(target_, ignored);
  if (!target_.has_filename() || (fs::exists(status) && !fs::is_regular_file(status))) {
    throw InputError(
        fmt::format("{}: cannot be written: is not a regular file", target.string()));
  }
  for (int attempt = 0; attempt < 1000; ++attempt) {
    temporary_ =
        folder_of(target_) /
        fmt::format(".{}.{}-{}.tmp", target_.filename().string(), ::getpid(), attempt);
    // Not mkstemp: the file gets the permissions that the user's umask grants.
    const int fd =
        ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (fd >= 0) {
      ::close(fd);
      return;
    }
    if (errno != EEXIST) {
      break;
    }
  }
  cannot_be(target, "written", errno);
}

AtomicFile::~AtomicFile() {
  if (!committed_) {
    ::unlink(temporary_.c_str());
  }
}

void AtomicFile::write(std::span<const std::byte> bytes) const {
  const int fd = ::open(temporary_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
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
  if (error != 0) {
    cannot_be(target_, "written", error);
  }
}

void AtomicFile::commit() {
  sync(temporary_, O_RDONLY, target_);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    cannot_be(target_, "written", errno);
  }
  committed_ = true;
  sync(folder_of(target_), O_RDONLY | O_DIRECTORY, target_);
}

}  // namespace palpate
