// Numbers as they lie in memory, for processes of one program.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "formats/base/error.h"

namespace palpate {

template <typename T>
requires std::is_trivially_copyable_v<T>
void append_bytes(std::vector<char>& bytes, const T* data, std::size_t count) {
  const auto* first = reinterpret_cast<const char*>(data);
  bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

/// Takes them off the front of `bytes`.
/// @throws NumericalError if there are fewer.
template <typename T>
requires std::is_trivially_copyable_v<T>
void take_bytes(std::span<const char>& bytes, T* data, std::size_t count) {
  const std::size_t size = count * sizeof(T);
  if (bytes.size() < size) {
    throw NumericalError("what another process sent is cut short");
  }
  if (size > 0) {
    std::memcpy(data, bytes.data(), size);
  }
  bytes = bytes.subspan(size);
}

/// With their number before them.
template <typename T>
void append_bytes(std::vector<char>& bytes, const std::vector<T>& numbers) {
  const std::size_t count = numbers.size();
  append_bytes(bytes, &count, 1);
  append_bytes(bytes, numbers.data(), count);
}

/// What append_bytes() of a vector put there. @throws NumericalError if it is cut
/// short.
template <typename T>
void take_bytes(std::span<const char>& bytes, std::vector<T>& numbers) {
  std::size_t count = 0;
  take_bytes(bytes, &count, 1);
  if (count > bytes.size() / sizeof(T)) {
    throw NumericalError("what another process sent is cut short");
  }
  numbers.resize(count);
  take_bytes(bytes, numbers.data(), count);
}

}  // namespace palpate
