#include <system_error>

#include "formats/base/believed_bytes.h"

namespace palpate {

std::uintmax_t written_bytes(const std::filesystem::path& file) {
  std::error_code unknown;
  const std::uintmax_t bytes = std::filesystem::file_size(file, unknown);
  return unknown ? 0 : bytes;
}

}  // namespace palpate
