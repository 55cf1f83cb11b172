// Whether a body's factor fits into this machine, said before it is made.
#pragma once

#include <cstdint>

namespace palpate {

/// What programs may still take without anything being swapped [bytes] (MemAvailable of
/// proc(5), and the process's control group's limit where it is smaller); the largest
/// number where the system does not say.
[[nodiscard]] std::int64_t free_memory_bytes();

/// Peak memory [bytes] of factorising a compact body in quadratic tets that grow
/// inwards from a surface of so many triangles: rather too much, because too little
/// ends in a killed build. Within 5 % of an organ of 5,120 and 20,480 triangles, a
/// third more than cylinders of 3,000 to 15,000 need (tests/bench/factor_study.cc).
/// Thin bodies take less, bodies of equal tets more.
[[nodiscard]] double expected_memory_bytes(std::int64_t triangles);

/// @throws InputError saying what to do if a body of so many surface triangles would
/// need 1.4 times more than what is free: more than the expectation can be wrong by.
void require_memory(std::int64_t triangles);

}  // namespace palpate
