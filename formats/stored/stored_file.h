// What a reader of databases asks of a file, whatever its form: HDF5 or flat. Objects
// have paths ("/body/position_m"). They are groups, datasets or texts, and carry
// attributes.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/stored/stored_type.h"

namespace palpate {

/// What a path leads to: nothing, an object of the file itself, or a place outside it
/// that nobody named.
enum class StoredLink { kNone, kObject, kElsewhere };

/// What a dataset claims to be. It may be foreign or hostile: whoever reads it checks
/// first.
struct StoredClaim {
  std::optional<StoredType> type = {};     ///< none: none of those
  bool array = false;                      ///< else one value, or none
  bool scalar = false;                     ///< one value
  std::vector<std::uint64_t> extent = {};  ///< of an array
};

/// An open dataset. Every method @throws FormatError naming the file and the dataset.
class StoredDataset {
 public:
  explicit StoredDataset(StoredClaim claim) : claim_(std::move(claim)) {}
  virtual ~StoredDataset() = default;
  StoredDataset(const StoredDataset&) = delete;
  StoredDataset& operator=(const StoredDataset&) = delete;

  [[nodiscard]] const StoredClaim& claim() const noexcept { return claim_; }

  /// Requires that every byte of it is in this file, so that it may be believed how
  /// large it is. To be called of an array of a known type.
  virtual void require_bytes() const = 0;

  /// Rows [begin, begin + count) of an array of a known type.
  /// @param to room for them; count > 0, and the rows must be in the dataset
  virtual void read(std::int64_t begin, std::int64_t count, void* to) const = 0;

 private:
  StoredClaim claim_;
};

/// An open file. Paths and names are what a reader asks for, never what a file says.
/// Nothing is allocated because a file claims to be large. One thread at a time, which
/// mutex() sees to.
class StoredFile {
 public:
  explicit StoredFile(std::string name) : name_(std::move(name)) {}
  virtual ~StoredFile() = default;
  StoredFile(const StoredFile&) = delete;
  StoredFile& operator=(const StoredFile&) = delete;

  /// For messages: its path, or what its bytes are called.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// "an HDF5 file", "a flat file".
  [[nodiscard]] virtual const char* form() const = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;

  [[nodiscard]] virtual StoredLink link_at(const std::string& path) const = 0;
  /// @throws FormatError if the object is no group.
  virtual void require_group(const std::string& path) const = 0;

  /// Of an object that is there.
  [[nodiscard]] virtual bool has_attribute(const std::string& object,
                                           const char* name) const = 0;
  /// Of an attribute that is there; none: it is no text.
  [[nodiscard]] virtual std::optional<std::string> text_attribute(
      const std::string& object, const char* name) const = 0;
  /// Of an attribute that is there. @return false: it is not one number of this type.
  [[nodiscard]] virtual bool number_attribute(const std::string& object,
                                              const char* name, StoredType type,
                                              void* to) const = 0;

  /// Of an object that is there; none: it is no text.
  [[nodiscard]] virtual std::optional<std::string> text(
      const std::string& path) const = 0;
  /// Of an object that is there. It must not outlive the file.
  [[nodiscard]] virtual std::unique_ptr<const StoredDataset> dataset(
      const std::string& path) const = 0;

  /// Whether the form shows VTK's readers what it holds: links to datasets, and a group
  /// with VTK's own header. The other two are of such a form alone.
  [[nodiscard]] virtual bool shows_vtk() const { return false; }
  [[nodiscard]] virtual bool same_object(const std::string& /*path*/,
                                         const std::string& /*other*/) const {
    return false;
  }
  [[nodiscard]] virtual bool has_vtk_header(const std::string& /*group*/) const {
    return false;
  }

  /// Excludes all other use of what lies beneath. It is the file's own, or the HDF5
  /// library's.
  [[nodiscard]] virtual std::recursive_mutex& mutex() const { return mutex_; }

  /// @throws FormatError with the file's name before it.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string name_;
  mutable std::recursive_mutex mutex_;
};

}  // namespace palpate
