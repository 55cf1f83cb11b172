// Eight doubles that are worked on side by side, whatever the processor. Only for
// sources that are compiled once for each instruction set (instruction_set.h).
//
// Every operation is rounded by itself in every SIMD element (no contraction), so that
// all instruction sets give the same bits. Sources that include this header may include
// nothing with inline functions of its own. The linker keeps one copy of such a
// function, and that copy might be one which another processor cannot run. All
// functions here are inlined always.
#pragma once

#include <cstddef>

#if defined(__AVX512F__)
#include <immintrin.h>  // inlined always, all of it
#endif

// Registers are passed to functions that are inlined, and to no others.
#pragma GCC diagnostic ignored "-Wpsabi"
#define PALPATE_INLINE [[gnu::always_inline]] inline

namespace palpate::lanes {

constexpr std::ptrdiff_t kWidth = 8;

// Doubles that one register holds, and the size of a kernel's tile of sums. The tile
// stays in registers: it has kTileLanes vectors of eight in each of kTileOthers rows or
// columns.
#if defined(__AVX512F__)
constexpr int kRegister = 8;
constexpr int kTileLanes = 3;
constexpr int kTileOthers = 8;
#elif defined(__AVX2__)
constexpr int kRegister = 4;
constexpr int kTileLanes = 1;
constexpr int kTileOthers = 6;
#else
constexpr int kRegister = 2;
constexpr int kTileLanes = 1;
constexpr int kTileOthers = 3;
#endif

using Register [[gnu::vector_size(kRegister * 8)]] = double;
// Where an address is only as aligned as a double is.
using AnyRegister [[gnu::vector_size(kRegister * 8), gnu::aligned(8), gnu::may_alias]] =
    double;

// Half as wide: so many floats.
using AnyFloats [[gnu::vector_size(kRegister * 4), gnu::aligned(4), gnu::may_alias]] =
    float;

struct Lanes {
  static constexpr int kParts = kWidth / kRegister;
  Register part[kParts];

  PALPATE_INLINE Lanes() : part{} {}
  PALPATE_INLINE explicit Lanes(double x) {
#pragma GCC unroll 4
    for (Register& p : part) {
      p = x - Register{};
    }
  }
  PALPATE_INLINE Lanes& operator+=(const Lanes& y) {
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) {
      part[i] += y.part[i];
    }
    return *this;
  }
  PALPATE_INLINE Lanes& operator-=(const Lanes& y) {
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) {
      part[i] -= y.part[i];
    }
    return *this;
  }
  PALPATE_INLINE Lanes& operator*=(const Lanes& y) {
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) {
      part[i] *= y.part[i];
    }
    return *this;
  }
  PALPATE_INLINE Lanes& operator/=(const Lanes& y) {
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) {
      part[i] /= y.part[i];
    }
    return *this;
  }
  PALPATE_INLINE Lanes& operator*=(double y) {
#pragma GCC unroll 4
    for (Register& p : part) {
      p *= y;
    }
    return *this;
  }
  PALPATE_INLINE Lanes& operator/=(double y) {
#pragma GCC unroll 4
    for (Register& p : part) {
      p /= y;
    }
    return *this;
  }
  PALPATE_INLINE double operator[](std::ptrdiff_t i) const {
    return part[i / kRegister][i % kRegister];
  }
};

PALPATE_INLINE Lanes operator+(Lanes x, const Lanes& y) {
  return x += y;
}
PALPATE_INLINE Lanes operator-(Lanes x, const Lanes& y) {
  return x -= y;
}
PALPATE_INLINE Lanes operator*(Lanes x, const Lanes& y) {
  return x *= y;
}
PALPATE_INLINE Lanes operator/(Lanes x, const Lanes& y) {
  return x /= y;
}
PALPATE_INLINE Lanes operator*(Lanes x, double y) {
  return x *= y;
}
PALPATE_INLINE Lanes operator/(Lanes x, double y) {
  return x /= y;
}

PALPATE_INLINE Lanes load(const double* at) {
  Lanes x;
#pragma GCC unroll 4
  for (int i = 0; i < Lanes::kParts; ++i) {
    x.part[i] =
        *reinterpret_cast<const AnyRegister*>(at + std::ptrdiff_t{i} * kRegister);
  }
  return x;
}

PALPATE_INLINE Lanes load(const float* at) {
  Lanes x;
#pragma GCC unroll 4
  for (int i = 0; i < Lanes::kParts; ++i) {
    const AnyFloats& floats =
        *reinterpret_cast<const AnyFloats*>(at + std::ptrdiff_t{i} * kRegister);
#if defined(__AVX512F__)
    x.part[i] = _mm512_maskz_cvtps_pd(0xff, floats);  // GCC 12: by halves, else
#else
    x.part[i] = __builtin_convertvector(floats, Register);
#endif
  }
  return x;
}

PALPATE_INLINE void store(double* at, const Lanes& x) {
#pragma GCC unroll 4
  for (int i = 0; i < Lanes::kParts; ++i) {
    *reinterpret_cast<AnyRegister*>(at + std::ptrdiff_t{i} * kRegister) = x.part[i];
  }
}

// Where `test` is above zero `yes`, else `no`.
PALPATE_INLINE Lanes select_positive(const Lanes& test, const Lanes& yes,
                                     const Lanes& no) {
  Lanes x;
#pragma GCC unroll 4
  for (int i = 0; i < Lanes::kParts; ++i) {
    x.part[i] = test.part[i] > Register{} ? yes.part[i] : no.part[i];
  }
  return x;
}

PALPATE_INLINE Lanes smaller_of(const Lanes& x, const Lanes& y) {
  Lanes least;
#pragma GCC unroll 4
  for (int i = 0; i < Lanes::kParts; ++i) {
    least.part[i] = x.part[i] < y.part[i] ? x.part[i] : y.part[i];
  }
  return least;
}

PALPATE_INLINE double sum(const Lanes& x) {
  return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

}  // namespace palpate::lanes
