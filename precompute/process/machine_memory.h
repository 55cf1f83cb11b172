// Whether a body's factor fits into this machine, said before it is made.
#pragma once

#include <cstdint>

namespace palpate {

/// What programs may still take without anything being swapped [bytes] (MemAvailable of
/// proc(5), and the process's control group's limit where it is smaller); the largest
/// number where the system does not say.
[[nodiscard]] std::int64_t free_memory_bytes();

/// Peak memory [bytes] of factorising a compact body in quadratic tets that grow
/// inwards from a surface of so many triangles: a power fitted to cylinders of 1,500 to
/// 15,000 triangles, within 4 % of each (tests/bench/factor_study.cc). Thin bodies take
/// less, bodies of equal tets more.
[[nodiscard]] double expected_memory_bytes(std::int64_t triangles);

/// @throws InputError saying what to do if a body of so many surface triangles would
/// need 1.5 times more than what is free: more than the expectation can be wrong by.
void require_memory(std::int64_t triangles);

}  // namespace palpate
