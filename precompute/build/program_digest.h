// Which program computes.
#pragma once

namespace palpate {

/// SHA-256 of the sources that results depend on, taken when they were compiled: two
/// programs of one version may not give the same numbers.
[[nodiscard]] const char* program_digest();

}  // namespace palpate
