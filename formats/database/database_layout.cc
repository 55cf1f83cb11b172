#include "formats/database/database_layout.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate::content {

void read_version(StoredReader& file) {
  std::string format;
  std::int64_t major = 0;
  std::int64_t minor = 0;
  if (!file.has_attribute("/", "format")) {
    file.fail(fmt::format(
        "is {} of another kind: attribute /@format is missing, must be \"{}\"",
        file.file().form(), kFormatName));
  }
  file.attribute("/", "format", format);
  if (format != kFormatName) {
    file.fail(fmt::format("is {} of another kind: /@format is {:?}, must be \"{}\"",
                          file.file().form(), format.substr(0, 80), kFormatName));
  }
  file.attribute("/", "format_version", major);
  if (major != kDatabaseVersion) {
    file.fail(fmt::format("has format version {}, this program reads {}{}", major,
                          kDatabaseVersion,
                          major > kDatabaseVersion ? "; use a newer one" : ""));
  }
  file.attribute("/", "format_version_minor", minor);
  if (minor < 0) {
    file.fail(fmt::format("/@format_version_minor is {}, must be 0 or more", minor));
  }
}

std::vector<std::string> read_tool_names(StoredReader& file) {
  std::string names;
  file.group("/tools");
  file.attribute("/tools", "names", names);
  return split_lines(names);
}

void exchange_storage(StoredReader& file, StorageOptions& storage) {
  file.group("/storage");
  try {
    storage.precision = precision_of(file.remark("/storage", "precision"));
  } catch (const InputError& error) {
    file.fail(fmt::format("attribute /storage@precision: {}", error.what()));
  }
  const std::string compression = file.remark("/storage", "compression");
  if (compression != "none" && compression != "deflate") {
    file.fail(fmt::format(
        "attribute /storage@compression is {:?}, must be \"none\" or \"deflate\"",
        compression.substr(0, 80)));
  }
  storage.compress = compression == "deflate";
  storage.chunk_nodes = file.remark_number("/storage", "chunk_nodes");
  if (storage.chunk_nodes < 1 || storage.chunk_nodes > kLargestChunkNodes) {
    file.fail(fmt::format("attribute /storage@chunk_nodes is {}, must lie in [1, {}]",
                          storage.chunk_nodes, kLargestChunkNodes));
  }
}

}  // namespace palpate::content
