// What the header of a PLY file announces.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };

enum class PlyType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat32,
  kFloat64
};

/// Bytes of one value in a binary file.
[[nodiscard]] std::size_t bytes_of(PlyType type);
[[nodiscard]] bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< of a list's length; an integer
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> property;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> element;
  std::size_t bytes = 0;  ///< the data begin here
};

/// Every element has a property, and no more rows than the file has bytes.
/// @throws FormatError naming the line, from 1, and what is wrong with it.
[[nodiscard]] PlyHeader read_ply_header(std::string_view bytes);

}  // namespace palpate
