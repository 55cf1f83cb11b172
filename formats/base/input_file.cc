#include "formats/base/input_file.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/utf8_path.h"

namespace palpate {
namespace {

[[noreturn]] void cannot_be_read(const std::filesystem::path& file,
                                 const std::string& why) {
  throw InputError(fmt::format("{}: cannot be read: {}", utf8_of(file), why));
}

}  // namespace

void require_regular_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    cannot_be_read(file, "no such file");
  }
  if (error) {
    cannot_be_read(file, error.message());
  }
  if (std::filesystem::is_directory(status)) {
    cannot_be_read(file, "it is a folder");
  }
  if (!std::filesystem::is_regular_file(status)) {
    cannot_be_read(file, "it is not a regular file");
  }
}

std::string read_file(const std::filesystem::path& file, std::size_t most_bytes,
                      const char* what) {
  require_regular_file(file);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) {
    cannot_be_read(file, error.message());
  }
  if (bytes > most_bytes) {
    throw InputError(fmt::format("{}: is larger than {} bytes, must be {}",
                                 utf8_of(file), most_bytes, what));
  }
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::string content(bytes, '\0');
  in.read(content.data(), static_cast<std::streamsize>(bytes));
  if (!in) {
    cannot_be_read(file, errno == 0 ? "it became shorter" : std::strerror(errno));
  }
  return content;
}

}  // namespace palpate
