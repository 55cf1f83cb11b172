// How long the random walks of tests are.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace palpate {

/// Or PALPATE_WALK_TICKS of them.
inline std::int64_t walk_ticks(std::int64_t otherwise) {
  const char* wanted = std::getenv("PALPATE_WALK_TICKS");
  return wanted != nullptr ? std::atoll(wanted) : otherwise;
}

}  // namespace palpate
