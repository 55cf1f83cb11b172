#include "formats/base/believed_bytes.h"

#include <algorithm>
#include <system_error>

namespace palpate {

std::uintmax_t believed_bytes(const std::filesystem::path& file) {
  constexpr std::uintmax_t kSmall = std::uintmax_t{1} << 30;
  std::error_code unknown;
  const std::uintmax_t bytes = std::filesystem::file_size(file, unknown);
  if (unknown) {
    return 0;
  }
  const std::uintmax_t written = written_bytes(file);
  return bytes / kInflation > written ? std::min(bytes, std::max(kSmall, written))
                                      : bytes;
}

}  // namespace palpate
