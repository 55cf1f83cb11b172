#include "formats/base/utf8_path.h"

#include <system_error>

#include "formats/base/error.h"

namespace palpate {

std::filesystem::path path_of_utf8(std::string_view name) {
  try {
    return std::u8string(name.begin(), name.end());
  } catch (const std::system_error&) {
    throw InputError("the name of a file is not in UTF-8");
  }
}

std::string utf8_of(const std::filesystem::path& path) {
  const std::u8string name = path.u8string();
  return {name.begin(), name.end()};
}

}  // namespace palpate
