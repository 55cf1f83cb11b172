// Types and shapes of what a database stores, the same in each of its forms.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace palpate {

/// Element types that a dataset can have; all little-endian in the file.
enum class StoredType { kFloat64, kFloat32, kInt64, kInt32, kInt16, kUint8 };

template <typename T>
constexpr StoredType stored_type() {
  if constexpr (std::same_as<T, double>) {
    return StoredType::kFloat64;
  } else if constexpr (std::same_as<T, float>) {
    return StoredType::kFloat32;
  } else if constexpr (std::same_as<T, std::int64_t>) {
    return StoredType::kInt64;
  } else if constexpr (std::same_as<T, std::int32_t>) {
    return StoredType::kInt32;
  } else if constexpr (std::same_as<T, std::int16_t>) {
    return StoredType::kInt16;
  } else {
    static_assert(std::same_as<T, std::uint8_t>);
    return StoredType::kUint8;
  }
}

/// "float64", "float32", "int64", "int32", "int16", "uint8".
[[nodiscard]] const char* name_of(StoredType type);
[[nodiscard]] std::size_t bytes_of(StoredType type);

/// Extents of a dataset, rows first; in what a reader asks for, -1 takes any.
using StoredShape = std::vector<std::int64_t>;

/// Values per row, 0 for one dimension: the columns that the digest names.
[[nodiscard]] std::int64_t columns_of(const StoredShape& shape);
[[nodiscard]] std::size_t values_in(const StoredShape& shape);

template <typename T>
using RowMajor3 = Eigen::Matrix<T, Eigen::Dynamic, 3, Eigen::RowMajor>;
template <typename T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace palpate
