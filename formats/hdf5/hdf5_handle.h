// Ownership of HDF5 identifiers. Beside this sub-room only the readers of recordings
// and of afmformats files call HDF5's C interface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

#include <hdf5.h>

#include "formats/stored/stored_type.h"

namespace palpate::hdf5 {

/// Closes an identifier by its own close function; negative ones are not open.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) {
      close_(id_);
    }
  }
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Opens a regular file to read; HDF5 takes its name in UTF-8. A damaged one is refused
/// at once: HDF5 would read the metadata of one that another process writes again and
/// again.
/// @param flags beside H5F_ACC_RDONLY
/// @returns an identifier to close, negative where HDF5 refuses the file. @throws
/// InputError if it is no regular file.
[[nodiscard]] hid_t open_read_only(const std::filesystem::path& file,
                                   unsigned flags = 0);

/// The same of bytes in memory, which HDF5 copies.
[[nodiscard]] hid_t open_in_memory(std::span<const std::byte> bytes);

/// What a path leads to, over hard links alone: soft and external ones are not
/// followed, because they lead to files that nobody named.
enum class Link { kNone, kHard, kOther };
[[nodiscard]] Link link_at(hid_t file, const std::string& path);

/// Whether a dataset's bytes are all in its own file, and all written: none external,
/// virtual or left out. Those left out would read as zeros, as many as the file claims.
[[nodiscard]] bool holds_its_bytes(hid_t dataset);

/// The file's type of an element; memory's is the same, on a little-endian machine.
[[nodiscard]] hid_t file_type(StoredType type);

/// A fixed-length, null-padded UTF-8 string of at least one byte.
[[nodiscard]] Handle string_type(std::size_t bytes);

/// HDF5's own word on its latest failure, in one line.
[[nodiscard]] std::string last_failure();

/// The group VTKHDF as VTK 9.1 reads it.
constexpr std::array<std::int64_t, 2> kVtkVersion{1, 0};
constexpr hsize_t kVtkVersionSize = 2;
constexpr const char* kVtkType = "UnstructuredGrid";

}  // namespace palpate::hdf5
