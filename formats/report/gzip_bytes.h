// Bytes as browsers unpack them by themselves (DecompressionStream).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

/// gzip (RFC 1952), as small as deflate gets. Equal input gives equal bytes.
[[nodiscard]] std::vector<std::byte> gzip_bytes(std::span<const std::byte> bytes);

}  // namespace palpate
