// The digest of what a database says, whatever its form (FORMAT.md, "Digest").
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/base/sha256.h"
#include "formats/stored/stored_type.h"

namespace palpate {

/// The file's attribute that holds its digest.
inline constexpr const char* kDigestName = "content_sha256";

/// SHA-256 over the logical content, item by item. An item's head says its path, type,
/// rows and columns.
class ContentDigest {
 public:
  /// An attribute or a scalar dataset of this text.
  void add_text(const std::string& path, const std::string& value);
  /// An attribute that is one number.
  void add_number(const std::string& path, StoredType type, const void* value);
  void add_dataset(const std::string& path, StoredType type, const StoredShape& shape,
                   const void* data);
  /// A dataset of doubles, whatever the file keeps them in.
  void add_reals(const std::string& path, const std::vector<double>& values);

  [[nodiscard]] std::string hex() const { return digest_.hex(); }

 private:
  void add(const std::string& path, const char* type, std::int64_t rows,
           std::int64_t columns, const void* data, std::size_t bytes);

  Sha256 digest_;
};

}  // namespace palpate
