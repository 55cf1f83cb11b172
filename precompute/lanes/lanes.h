// Eight doubles that are worked on side by side, whatever the processor: for sources
// that are compiled once for each instruction set (instruction_set.h), and for nothing
// else.
//
// Every operation is rounded by itself in every lane (no contraction), so that all
// instruction sets give the same bits. Sources that include this may include nothing
// with inline functions of its own: the linker keeps one copy of such a function, and
// that copy might be one which another processor cannot run.
#pragma once

#include <cstddef>

// Lanes are passed to functions that are inlined, and to no others.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace palpate::lanes {

constexpr std::ptrdiff_t kWidth = 8;

using Lanes [[gnu::vector_size(64)]] = double;
// Where an address is only as aligned as a double is.
using AnyLanes [[gnu::vector_size(64), gnu::aligned(8), gnu::may_alias]] = double;

// How many registers of Lanes a kernel's tile may take, and how many rows or columns of
// one it should have, so that sums stay in registers.
#if defined(__AVX512F__)
constexpr int kTileLanes = 3;  // 32 registers of one Lanes
constexpr int kTileOthers = 8;
#elif defined(__AVX2__)
constexpr int kTileLanes = 1;  // 16 registers of half a Lanes
constexpr int kTileOthers = 6;
#else
constexpr int kTileLanes = 1;  // 16 registers of a quarter
constexpr int kTileOthers = 3;
#endif

[[gnu::always_inline]] inline Lanes load(const double* at) {
  return *reinterpret_cast<const AnyLanes*>(at);
}

[[gnu::always_inline]] inline void store(double* at, const Lanes& x) {
  *reinterpret_cast<AnyLanes*>(at) = x;
}

[[gnu::always_inline]] inline double sum(const Lanes& x) {
  return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

}  // namespace palpate::lanes
