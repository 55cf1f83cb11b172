// SHA-256 of inputs, for provenance.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// 64 lower-case hexadecimal digits. @throws InputError if the file cannot be read.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace palpate
