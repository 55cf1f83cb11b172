#include "formats/stored/content_digest.h"

#include <span>

#include <fmt/format.h>

namespace palpate {

void ContentDigest::add(const std::string& path, const char* type, std::int64_t rows,
                        std::int64_t columns, const void* data, std::size_t bytes) {
  const std::string head = fmt::format("{} {} {} {}\n", path, type, rows, columns);
  digest_.update(std::as_bytes(std::span(head)));
  digest_.update({static_cast<const std::byte*>(data), bytes});
}

void ContentDigest::add_text(const std::string& path, const std::string& value) {
  add(path, "text", static_cast<std::int64_t>(value.size()), 0, value.data(),
      value.size());
}

void ContentDigest::add_number(const std::string& path, StoredType type,
                               const void* value) {
  add(path, name_of(type), 1, 0, value, bytes_of(type));
}

void ContentDigest::add_dataset(const std::string& path, StoredType type,
                                const StoredShape& shape, const void* data) {
  add(path, name_of(type), shape.front(), columns_of(shape), data,
      values_in(shape) * bytes_of(type));
}

void ContentDigest::add_reals(const std::string& path,
                              const std::vector<double>& values) {
  add_dataset(path, StoredType::kFloat64, {static_cast<std::int64_t>(values.size())},
              values.data());
}

}  // namespace palpate
