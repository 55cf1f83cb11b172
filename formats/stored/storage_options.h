// How precisely and how densely a file keeps a database: a choice that does not change
// what the numbers mean.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace palpate {

/// Element type of sampled depths and forces. All but kFloat64 leave slopes and
/// energies out of the file: readers make them anew from depths and forces.
enum class Precision {
  kFloat64,
  kFloat32,
  kInt16,  ///< 15 bits of the node's largest depth and force
};

/// "float64", "float32", "int16".
[[nodiscard]] const char* name_of(Precision precision);

/// @throws InputError naming the precisions that there are.
[[nodiscard]] Precision precision_of(const std::string& name);

/// The largest step of a scaled 16-bit number: values are k scale, k in [0,
/// kInt16Steps].
constexpr double kInt16Steps = 32767.0;

/// Scale of a node's values: their largest over kInt16Steps, rounded up to a float; 0
/// where all are 0. A float, because then k scale is exact in double precision and
/// rounding twice is rounding once.
[[nodiscard]] double int16_scale(std::span<const double> values);

constexpr std::int64_t kDefaultChunkNodes = 256;
constexpr std::int64_t kLargestChunkNodes = std::int64_t{1} << 20;

struct StorageOptions {
  Precision precision = Precision::kFloat64;
  bool compress = false;                          ///< shuffle and deflate
  std::int64_t chunk_nodes = kDefaultChunkNodes;  ///< [1, 2^20] neighbours per chunk
};

}  // namespace palpate
