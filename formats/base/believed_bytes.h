// How large a file may be believed to be. A file with holes states any size at no cost.
#pragma once

#include <cstdint>
#include <filesystem>

namespace palpate {

/// What a file takes on its disk; its size where the system does not say. [bytes] 0: it
/// is not there.
[[nodiscard]] std::uintmax_t written_bytes(const std::filesystem::path& file);

/// Deflate makes at most so many bytes of one.
inline constexpr std::uint64_t kInflation = 1032;

/// A file's size [bytes], where it can be believed: a file system that compresses
/// writes less than that, but not less than deflate would. Of a file with holes what it
/// takes on its disk, or one gibibyte.
[[nodiscard]] std::uintmax_t believed_bytes(const std::filesystem::path& file);

}  // namespace palpate
