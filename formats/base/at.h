// Signed indices, as Eigen and sparse matrices have them, into standard containers.
#pragma once

#include <cstddef>

namespace palpate {

template <typename T>
[[nodiscard]] constexpr std::size_t at(T i) {
  return static_cast<std::size_t>(i);
}

}  // namespace palpate
