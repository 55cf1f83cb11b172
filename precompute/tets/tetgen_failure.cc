#include "precompute/tets/tetgen_failure.h"

#include <fmt/format.h>

// Must not see tetgen.h, which defines the function as an inline one.
class tetgenmesh;  // NOLINT(readability-identifier-naming)

// NOLINTNEXTLINE(misc-definitions-in-headers)
[[noreturn]] __attribute__((visibility("default"))) void terminatetetgen(
    tetgenmesh* /*mesh*/, int code) {
  throw code;
}

namespace palpate {

std::string tetgen_failure(int code) {
  switch (code) {
    case 1:
      return "out of memory";
    case 2:
      return "internal error";
    case 3:
      return "the surface intersects itself";
    case 4:
      return "the surface has a feature too small to resolve";
    case 5:
      return "two facets of the surface are too close";
    case 10:
      return "the surface is not a valid input";
    default:
      return fmt::format("unknown code {}", code);
  }
}

}  // namespace palpate
