// The readers take files: one file in memory that each input overwrites.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace palpate {

class InputFile {
 public:
  /// @param extension e.g. ".obj": mesh readers go by it.
  explicit InputFile(const std::string& extension)
      : folder_("/dev/shm/palpate-fuzz-" + std::to_string(::getpid())),
        path_(folder_ / ("input" + extension)) {
    std::filesystem::create_directories(folder_);
    descriptor_ = ::open(path_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  }
  ~InputFile() {
    ::close(descriptor_);
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    std::filesystem::remove(folder_, ignored);  // only if it is empty
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// @return the path, or an empty one if the bytes could not be written.
  [[nodiscard]] std::filesystem::path with(const std::uint8_t* data, std::size_t size) {
    const bool done =
        ::ftruncate(descriptor_, 0) == 0 &&
        ::pwrite(descriptor_, data, size, 0) == static_cast<ssize_t>(size);
    return done ? path_ : std::filesystem::path();
  }

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace palpate
