// What a flat file says it holds: its header and its directory, as FLAT.md has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/stored/stored_type.h"

namespace palpate {

inline constexpr std::string_view kFlatMagic{"\x89PAL\r\n\x1a\n", 8};
inline constexpr std::uint32_t kFlatVersion = 1;  ///< readers refuse another one
inline constexpr std::size_t kFlatHeaderBytes = 96;
inline constexpr std::uint64_t kFlatAlignment = 64;  ///< [bytes] of what has bytes

/// What an object or an attribute is: a code of the file.
enum class FlatKind : std::uint8_t {
  kGroup = 0,
  kFloat64 = 1,  ///< and on, in the order of StoredType
  kText = 7
};

[[nodiscard]] constexpr FlatKind flat_kind(StoredType type) {
  return static_cast<FlatKind>(static_cast<int>(type) + 1);
}
/// None: a group or a text.
[[nodiscard]] std::optional<StoredType> stored_type_of(FlatKind kind);

struct FlatAttribute {
  FlatKind kind = FlatKind::kText;
  std::string value = {};  ///< its bytes: a text, numbers
};

struct FlatObject {
  FlatKind kind = FlatKind::kGroup;
  std::vector<std::uint64_t> extent = {};  ///< of a text its bytes, of a group none
  std::uint64_t offset = 0;                ///< [bytes] in the file; of a group 0
  std::map<std::string, FlatAttribute, std::less<>> attributes = {};

  /// What it takes in the file, where the extent does not overflow; else none.
  [[nodiscard]] std::optional<std::uint64_t> bytes() const;
};

using FlatDirectory = std::map<std::string, FlatObject, std::less<>>;

struct FlatHeader {
  std::uint32_t version = kFlatVersion;
  std::uint32_t objects = 0;
  std::uint64_t bytes = 0;      ///< of the file
  std::uint64_t directory = 0;  ///< [bytes] where it begins; it ends with the file
  std::string sha256 = {};      ///< 64 hexadecimal digits
};

/// The next multiple of kFlatAlignment.
[[nodiscard]] constexpr std::uint64_t flat_aligned(std::uint64_t offset) {
  return (offset + kFlatAlignment - 1) / kFlatAlignment * kFlatAlignment;
}
inline constexpr std::uint64_t kFlatFirstOffset = flat_aligned(kFlatHeaderBytes);

/// The header's bytes. @param header of a digest of header and directory, or none
[[nodiscard]] std::string flat_header(const FlatHeader& header);

/// SHA-256 of the header's first 32 bytes and of the directory.
[[nodiscard]] std::string flat_sha256(const FlatHeader& header,
                                      std::string_view directory);

/// @param head kFlatHeaderBytes, which begin with the magic.
[[nodiscard]] FlatHeader read_flat_header(std::string_view head);

/// One object's entry of the directory.
[[nodiscard]] std::string flat_entry(const std::string& path, const FlatObject& object);

/// Reads all entries. They are believed in nothing: lengths stay within the bytes, data
/// within the file, one after the other without overlap.
/// @throws FormatError with what is wrong, without the file's name.
[[nodiscard]] FlatDirectory read_flat_directory(const FlatHeader& header,
                                                std::string_view directory);

}  // namespace palpate
