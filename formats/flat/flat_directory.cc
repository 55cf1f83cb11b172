#include "formats/flat/flat_directory.h"

#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/sha256.h"

namespace palpate {
namespace {

constexpr std::size_t kMostRank = 3;

template <typename Number>
void append_number(Number value, std::string& to) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_text(std::string_view text, std::string& to) {
  append_number(static_cast<std::uint32_t>(text.size()), to);
  to += text;
}

// The header without its digest.
std::string undigested(const FlatHeader& header) {
  std::string head(kFlatMagic);
  append_number(header.version, head);
  append_number(header.objects, head);
  append_number(header.bytes, head);
  append_number(header.directory, head);
  return head;
}

// Goes over bytes that may end anywhere.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] std::string_view take(std::uint64_t count) {
    if (count > rest_.size()) {
      throw FormatError("the directory ends within an entry");
    }
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }
  template <typename Number>
  [[nodiscard]] Number number() {
    Number value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  [[nodiscard]] std::string text() {
    return std::string(take(number<std::uint32_t>()));
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

FlatKind checked_kind(std::uint8_t code, const std::string& what) {
  if (code > static_cast<std::uint8_t>(FlatKind::kText)) {
    throw FormatError(fmt::format("{:?} has the type {}, must be 0 to 7", what, code));
  }
  return static_cast<FlatKind>(code);
}

void read_attribute(Cursor& from, const std::string& path, FlatObject& object) {
  std::string name = from.text();
  FlatAttribute attribute;
  attribute.kind = checked_kind(from.number<std::uint8_t>(), path + "@" + name);
  attribute.value = from.text();
  if (!object.attributes.emplace(std::move(name), std::move(attribute)).second) {
    throw FormatError(fmt::format("{:?} has two attributes of one name", path));
  }
}

FlatObject read_object(Cursor& from, const std::string& path) {
  FlatObject object;
  object.kind = checked_kind(from.number<std::uint8_t>(), path);
  const auto rank = from.number<std::uint8_t>();
  const auto attributes = from.number<std::uint16_t>();
  if (rank > kMostRank || (object.kind == FlatKind::kGroup) != (rank == 0) ||
      (object.kind == FlatKind::kText && rank != 1)) {
    throw FormatError(
        fmt::format("{:?} has {} extents, must have 1 to {}, a text 1, a "
                    "group none",
                    path, rank, kMostRank));
  }
  object.offset = from.number<std::uint64_t>();
  for (std::size_t i = 0; i < rank; ++i) {
    object.extent.push_back(from.number<std::uint64_t>());
  }
  for (std::size_t i = 0; i < attributes; ++i) {
    read_attribute(from, path, object);
  }
  return object;
}

}  // namespace

std::optional<StoredType> stored_type_of(FlatKind kind) {
  if (kind == FlatKind::kGroup || kind == FlatKind::kText) {
    return std::nullopt;
  }
  return static_cast<StoredType>(static_cast<int>(kind) - 1);
}

std::optional<std::uint64_t> FlatObject::bytes() const {
  if (kind == FlatKind::kGroup) {
    return 0;
  }
  const std::optional<StoredType> type = stored_type_of(kind);
  std::uint64_t total = type ? bytes_of(*type) : 1;
  bool empty = false;
  for (const std::uint64_t size : extent) {
    // Every extent by itself must be possible, also beside a zero.
    if (size > INT64_MAX / total) {
      return std::nullopt;
    }
    empty = empty || size == 0;
    total *= size == 0 ? 1 : size;
  }
  return empty ? 0 : total;
}

std::string flat_sha256(const FlatHeader& header, std::string_view directory) {
  Sha256 digest;
  const std::string head = undigested(header);
  digest.update(std::as_bytes(std::span(head)));
  digest.update(std::as_bytes(std::span(directory)));
  return digest.hex();
}

std::string flat_header(const FlatHeader& header) {
  std::string bytes = undigested(header) + header.sha256;
  bytes.resize(kFlatHeaderBytes);
  return bytes;
}

FlatHeader read_flat_header(std::string_view head) {
  Cursor from(head);
  static_cast<void>(from.take(kFlatMagic.size()));
  FlatHeader header;
  header.version = from.number<std::uint32_t>();
  header.objects = from.number<std::uint32_t>();
  header.bytes = from.number<std::uint64_t>();
  header.directory = from.number<std::uint64_t>();
  header.sha256 = from.take(kFlatHeaderBytes - undigested(header).size());
  return header;
}

std::string flat_entry(const std::string& path, const FlatObject& object) {
  std::string entry;
  append_text(path, entry);
  append_number(static_cast<std::uint8_t>(object.kind), entry);
  append_number(static_cast<std::uint8_t>(object.extent.size()), entry);
  append_number(static_cast<std::uint16_t>(object.attributes.size()), entry);
  append_number(object.offset, entry);
  for (const std::uint64_t size : object.extent) {
    append_number(size, entry);
  }
  for (const auto& [name, attribute] : object.attributes) {
    append_text(name, entry);
    append_number(static_cast<std::uint8_t>(attribute.kind), entry);
    append_text(attribute.value, entry);
  }
  return entry;
}

FlatDirectory read_flat_directory(const FlatHeader& header,
                                  std::string_view directory) {
  FlatDirectory all;
  Cursor from(directory);
  std::uint64_t end = kFlatFirstOffset;
  for (std::uint32_t i = 0; i < header.objects; ++i) {
    const std::string path = from.text();
    FlatObject object = read_object(from, path);
    if (object.kind != FlatKind::kGroup) {
      const std::optional<std::uint64_t> bytes = object.bytes();
      if (object.offset != flat_aligned(end) || object.offset > header.directory ||
          !bytes || *bytes > header.directory - object.offset) {
        throw FormatError(
            fmt::format("{:?} lies at {}, must follow at {} and end before the "
                        "directory at {}",
                        path, object.offset, flat_aligned(end), header.directory));
      }
      end = object.offset + *bytes;
    }
    if (!all.emplace(path, std::move(object)).second) {
      throw FormatError(fmt::format("the directory names {:?} twice", path));
    }
  }
  if (!from.at_end() || header.directory != flat_aligned(end)) {
    throw FormatError(fmt::format("the directory of {} objects does not end the file",
                                  header.objects));
  }
  return all;
}

}  // namespace palpate
