// Structs whose callers know them by headers of any age.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace palpate {

/// As much of a struct as its caller knows, who set struct_size; what it knows beyond
/// is zero.
template <typename Struct>
void copy_known(const Struct& all, Struct* to) noexcept {
  const std::size_t bytes = all.struct_size;
  std::memcpy(to, &all, std::min(bytes, sizeof(all)));
  if (bytes > sizeof(all)) {
    std::memset(reinterpret_cast<unsigned char*>(to) + sizeof(all), 0,
                bytes - sizeof(all));
  }
}

/// The same of a row of an array, each as wide as its caller knows it.
template <typename Struct>
void copy_row(const Struct& all, Struct* rows, std::size_t i,
              std::size_t row_bytes) noexcept {
  auto* to = reinterpret_cast<unsigned char*>(rows) + i * row_bytes;
  std::memset(to, 0, row_bytes);
  std::memcpy(to, &all, std::min(row_bytes, sizeof(all)));
}

}  // namespace palpate
