// Exceptions end at the C interface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <string_view>

#include "formats/base/error.h"
#include "runtime/c_api/palpate.h"

namespace palpate {

/// One line into a caller's text, cut where it ends.
inline void copy_text(std::string_view text, char* to, std::size_t bytes) noexcept {
  if (to != nullptr && bytes > 0) {
    const std::size_t kept = std::min(text.size(), bytes - 1);
    std::memcpy(to, text.data(), kept);
    to[kept] = '\0';
  }
}

inline int error_of(int exit_code) noexcept {
  switch (exit_code) {
    case 2:
      return PALPATE_ERROR_INPUT;
    case 3:
      return PALPATE_ERROR_FORMAT;
    default:
      return PALPATE_ERROR_INTERNAL;
  }
}

/// Calls `work`; an exception becomes an error and a line of text.
template <typename Work>
int guarded(char* error, std::size_t error_bytes, Work work) noexcept {
  try {
    return work();
  } catch (const Error& failure) {
    copy_text(failure.what(), error, error_bytes);
    return error_of(failure.exit_code());
  } catch (const std::exception& failure) {
    copy_text(failure.what(), error, error_bytes);
  } catch (...) {
    copy_text("unknown exception", error, error_bytes);
  }
  return PALPATE_ERROR_INTERNAL;
}

}  // namespace palpate
