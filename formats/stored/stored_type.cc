#include "formats/stored/stored_type.h"

#include <bit>
#include <functional>
#include <numeric>

namespace palpate {

static_assert(std::endian::native == std::endian::little,
              "datasets pass between file and memory without conversion");

const char* name_of(StoredType type) {
  switch (type) {
    case StoredType::kFloat64:
      return "float64";
    case StoredType::kFloat32:
      return "float32";
    case StoredType::kInt64:
      return "int64";
    case StoredType::kInt32:
      return "int32";
    case StoredType::kInt16:
      return "int16";
    case StoredType::kUint8:
      break;
  }
  return "uint8";
}

std::size_t bytes_of(StoredType type) {
  switch (type) {
    case StoredType::kFloat64:
    case StoredType::kInt64:
      return 8;
    case StoredType::kFloat32:
    case StoredType::kInt32:
      return 4;
    case StoredType::kInt16:
      return 2;
    case StoredType::kUint8:
      break;
  }
  return 1;
}

std::int64_t columns_of(const StoredShape& shape) {
  return shape.size() < 2 ? 0
                          : std::accumulate(shape.begin() + 1, shape.end(),
                                            std::int64_t{1}, std::multiplies<>());
}

std::size_t values_in(const StoredShape& shape) {
  return static_cast<std::size_t>(std::accumulate(
      shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>()));
}

}  // namespace palpate
