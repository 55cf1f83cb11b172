// A zip archive that nobody vouches for, read entry by entry.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Not for several threads at a time; open one for each.
class ZipArchive {
 public:
  /// @throws InputError for a missing file, FormatError for a broken archive.
  explicit ZipArchive(const std::filesystem::path& file);
  ~ZipArchive();
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool has(const std::string& name) const;

  /// The bytes of an entry. @throws FormatError for one that is absent, damaged or of
  /// more than kZipEntryMax bytes.
  [[nodiscard]] std::string read(const std::string& name) const;

 private:
  struct Handle;
  std::string file_;
  std::unique_ptr<Handle> handle_;
};

constexpr std::size_t kZipEntryMax = std::size_t{1} << 30;  ///< bytes, unpacked

/// The archive, kept open by this thread until the thread asks for another one or the
/// file has changed. So a map of thousands of curves is listed once. As the constructor
/// throws.
[[nodiscard]] const ZipArchive& open_archive(const std::filesystem::path& file);

/// Whether the bytes begin as a zip archive does.
[[nodiscard]] bool is_zip(std::string_view head);

}  // namespace palpate
