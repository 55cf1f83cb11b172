// Files that a user names: read whole, and never waited for.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>

namespace palpate {

/// Refuses what is no regular file: a pipe or a device would keep its reader waiting.
/// @throws InputError naming the file and what it is instead.
void require_regular_file(const std::filesystem::path& file);

/// All bytes of a regular file.
/// @param most_bytes larger files are refused before they are read
/// @param what what the file must be, for the message: "a scene file"
/// @throws InputError naming the file and why it cannot be read.
std::string read_file(const std::filesystem::path& file,
                      std::size_t most_bytes = std::numeric_limits<std::size_t>::max(),
                      const char* what = "a file");

}  // namespace palpate
