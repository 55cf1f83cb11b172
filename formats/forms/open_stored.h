// A database's file is HDF5 or flat: whoever opens one need not know which. Its first
// bytes tell.
#pragma once

#include <concepts>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "formats/base/utf8_path.h"
#include "formats/stored/stored_reader.h"
#include "formats/stored/stored_writer.h"

namespace palpate {

/// Where a file's bytes are: at a path, or in memory. What is in memory must outlive
/// what is opened.
class StoredSource {
 public:
  template <typename Path>
  // NOLINTNEXTLINE(google-explicit-constructor)
  requires std::convertible_to<Path, std::filesystem::path> StoredSource(
      const Path& path)
      : path_(path) {}
  /// @param name for messages
  explicit StoredSource(std::span<const std::byte> bytes,
                        const std::string& name = "bytes in memory")
      : path_(path_of_utf8(name)), bytes_(bytes), in_memory_(true) {}

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::string name() const { return utf8_of(path_); }
  [[nodiscard]] bool in_memory() const noexcept { return in_memory_; }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  std::filesystem::path path_;
  std::span<const std::byte> bytes_;
  bool in_memory_ = false;
};

/// @throws InputError if the file is missing or cannot be opened, FormatError if it is
/// neither, or is truncated.
[[nodiscard]] std::unique_ptr<const StoredFile> open_stored(const StoredSource& source);

/// The forms in which a file can be written.
enum class StoredForm { kHdf5, kFlat };

/// What a file's name asks for: flat for ".palpate", else HDF5; of a build without
/// HDF5 flat.
[[nodiscard]] StoredForm form_of(const std::filesystem::path& file);

/// A new file in memory. @throws InputError if this build does not write the form.
[[nodiscard]] StoredWriter make_writer(StoredForm form,
                                       const StorageOptions& storage = {});

/// The digest of the content, as a file states it. @throws as open_stored() does.
[[nodiscard]] std::string database_sha256(const StoredSource& source);

}  // namespace palpate
