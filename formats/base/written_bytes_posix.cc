#include <sys/stat.h>

#include "formats/base/believed_bytes.h"

namespace palpate {

std::uintmax_t written_bytes(const std::filesystem::path& file) {
  struct stat status {};
  constexpr std::uintmax_t kBlock = 512;
  return ::stat(file.c_str(), &status) == 0
             ? kBlock * static_cast<std::uintmax_t>(status.st_blocks)
             : 0;
}

}  // namespace palpate
