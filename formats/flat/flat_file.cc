#include "formats/flat/flat_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "formats/base/believed_bytes.h"
#include "formats/base/error.h"
#include "formats/base/utf8_path.h"
#include "formats/flat/flat_directory.h"

namespace palpate {
namespace {

// Where a flat file's bytes are.
class Bytes {
 public:
  Bytes() = default;
  virtual ~Bytes() = default;
  Bytes(const Bytes&) = delete;
  Bytes& operator=(const Bytes&) = delete;

  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// @param begin, count within size(). @return false: they cannot be read
  [[nodiscard]] virtual bool read(std::uint64_t begin, std::uint64_t count,
                                  void* to) const = 0;
};

class BytesInMemory final : public Bytes {
 public:
  explicit BytesInMemory(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] bool read(std::uint64_t begin, std::uint64_t count,
                          void* to) const override {
    std::memcpy(to, bytes_.data() + begin, count);
    return true;
  }

 private:
  std::span<const std::byte> bytes_;
};

// By reads, not by a map: a file that somebody cuts meanwhile is an error then, not a
// signal.
class BytesOnDisk final : public Bytes {
 public:
  explicit BytesOnDisk(const std::filesystem::path& file)
      : in_(file, std::ios::binary), size_(believed_bytes(file)) {}
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] bool read(std::uint64_t begin, std::uint64_t count,
                          void* to) const override {
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(begin));
    in_.read(static_cast<char*>(to), static_cast<std::streamsize>(count));
    return static_cast<bool>(in_);
  }

 private:
  mutable std::ifstream in_;
  std::uint64_t size_;
};

class FlatFile final : public StoredFile {
 public:
  FlatFile(std::string name, std::unique_ptr<const Bytes> bytes);

  [[nodiscard]] const char* form() const override { return "a flat file"; }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_->size(); }

  [[nodiscard]] StoredLink link_at(const std::string& path) const override {
    return path == "/" || directory_.contains(path) ? StoredLink::kObject
                                                    : StoredLink::kNone;
  }
  void require_group(const std::string& path) const override {
    if (object(path).kind != FlatKind::kGroup) {
      fail(fmt::format("{} cannot be opened as a group: it has data", path));
    }
  }
  [[nodiscard]] bool has_attribute(const std::string& path,
                                   const char* name) const override {
    return object(path).attributes.contains(name);
  }
  [[nodiscard]] std::optional<std::string> text_attribute(
      const std::string& path, const char* name) const override {
    const FlatAttribute& found = object(path).attributes.find(name)->second;
    return found.kind == FlatKind::kText ? std::optional(found.value) : std::nullopt;
  }
  [[nodiscard]] bool number_attribute(const std::string& path, const char* name,
                                      StoredType type, void* to) const override {
    const FlatAttribute& found = object(path).attributes.find(name)->second;
    if (found.kind != flat_kind(type) || found.value.size() != bytes_of(type)) {
      return false;
    }
    std::memcpy(to, found.value.data(), found.value.size());
    return true;
  }
  [[nodiscard]] std::optional<std::string> text(const std::string& path) const override;
  [[nodiscard]] std::unique_ptr<const StoredDataset> dataset(
      const std::string& path) const override;

  // @param begin from the begin of the object's bytes
  void read(const std::string& path, std::uint64_t begin, std::uint64_t count,
            void* to) const {
    if (!bytes_->read(object(path).offset + begin, count, to)) {
      fail(fmt::format("dataset {} cannot be read: the file became shorter", path));
    }
  }

 private:
  [[nodiscard]] const FlatObject& object(const std::string& path) const {
    return directory_.find(path)->second;
  }
  [[nodiscard]] std::string bytes_from(std::uint64_t begin, std::uint64_t count) const;
  [[nodiscard]] FlatHeader header() const;

  std::unique_ptr<const Bytes> bytes_;
  FlatDirectory directory_;
};

class FlatDataset final : public StoredDataset {
 public:
  FlatDataset(const FlatFile& file, std::string path, const FlatObject& object)
      : StoredDataset({.type = stored_type_of(object.kind),
                       .array = stored_type_of(object.kind).has_value(),
                       .extent = object.extent}),
        file_(file),
        path_(std::move(path)) {}

  // The directory was not taken otherwise.
  void require_bytes() const override {}

  void read(std::int64_t begin, std::int64_t count, void* to) const override {
    std::uint64_t row = bytes_of(*claim().type);
    for (std::size_t i = 1; i < claim().extent.size(); ++i) {
      row *= claim().extent[i];
    }
    file_.read(path_, static_cast<std::uint64_t>(begin) * row,
               static_cast<std::uint64_t>(count) * row, to);
  }

 private:
  const FlatFile& file_;
  std::string path_;
};

FlatFile::FlatFile(std::string name, std::unique_ptr<const Bytes> bytes)
    : StoredFile(std::move(name)), bytes_(std::move(bytes)) {
  const FlatHeader head = header();
  const std::string directory = bytes_from(head.directory, head.bytes - head.directory);
  if (head.sha256 != flat_sha256(head, directory)) {
    fail("is damaged: the SHA-256 of its directory is not the one it states");
  }
  try {
    directory_ = read_flat_directory(head, directory);
  } catch (const FormatError& error) {
    fail(error.what());
  }
  if (const auto root = directory_.find("/");
      root == directory_.end() || root->second.kind != FlatKind::kGroup) {
    fail("has no group /");
  }
}

std::string FlatFile::bytes_from(std::uint64_t begin, std::uint64_t count) const {
  std::string found(count, '\0');
  if (!bytes_->read(begin, count, found.data())) {
    fail("cannot be read: the file became shorter");
  }
  return found;
}

FlatHeader FlatFile::header() const {
  if (bytes() < kFlatFirstOffset) {
    fail(fmt::format("is truncated or damaged ({} bytes): a flat file has {} or more",
                     bytes(), kFlatFirstOffset));
  }
  const FlatHeader head = read_flat_header(bytes_from(0, kFlatHeaderBytes));
  if (head.version != kFlatVersion) {
    fail(fmt::format("is a flat file of version {}, this program reads {}{}",
                     head.version, kFlatVersion,
                     head.version > kFlatVersion ? "; use a newer one" : ""));
  }
  if (head.bytes != bytes() || head.directory < kFlatFirstOffset ||
      head.directory > bytes()) {
    fail(
        fmt::format("is truncated or damaged ({} bytes): it states {} bytes, and a "
                    "directory from {}",
                    bytes(), head.bytes, head.directory));
  }
  return head;
}

std::optional<std::string> FlatFile::text(const std::string& path) const {
  const FlatObject& found = object(path);
  if (found.kind != FlatKind::kText) {
    return std::nullopt;
  }
  return bytes_from(found.offset, found.extent.front());
}

std::unique_ptr<const StoredDataset> FlatFile::dataset(const std::string& path) const {
  const FlatObject& found = object(path);
  if (found.kind == FlatKind::kGroup) {
    fail(fmt::format("dataset {} cannot be opened: it is a group", path));
  }
  return std::make_unique<const FlatDataset>(*this, path, found);
}

}  // namespace

std::unique_ptr<const StoredFile> open_flat(const std::filesystem::path& file) {
  if (std::error_code unknown;
      believed_bytes(file) < std::filesystem::file_size(file, unknown)) {
    throw FormatError(
        fmt::format("{}: has holes: most of its {} bytes were never written",
                    utf8_of(file), std::filesystem::file_size(file, unknown)));
  }
  return std::make_unique<const FlatFile>(utf8_of(file),
                                          std::make_unique<const BytesOnDisk>(file));
}

std::unique_ptr<const StoredFile> open_flat(std::span<const std::byte> bytes,
                                            const std::string& name) {
  return std::make_unique<const FlatFile>(name,
                                          std::make_unique<const BytesInMemory>(bytes));
}

}  // namespace palpate
