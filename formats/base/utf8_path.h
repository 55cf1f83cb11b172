// Names of files in UTF-8, whatever a system's own names are: Windows' are UTF-16, and
// its standard library takes a narrow name byte by byte.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// @throws InputError where the system needs UTF-8 and the name is none
[[nodiscard]] std::filesystem::path path_of_utf8(std::string_view name);

/// For messages, and for names that are stored.
[[nodiscard]] std::string utf8_of(const std::filesystem::path& path);

}  // namespace palpate
