// HDF5 files as the database needs them: flat datasets with a unit, small attributes,
// and a digest of everything that passes through. Beside this sub-room only the readers
// of recordings and of afmformats files call HDF5's C interface.
//
// Hdf5Writer and Hdf5Reader (hdf5_reader.h) have the same methods. So one template
// states for both what a file holds and in which order. Not thread-safe, because the
// HDF5 library is not: Hdf5Lock.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "formats/base/sha256.h"
#include "formats/hdf5/storage_options.h"

namespace palpate {

/// Element types that a dataset can have; all little-endian in the file.
enum class Hdf5Type { kFloat64, kFloat32, kInt64, kInt32, kInt16, kUint8 };

template <typename T>
constexpr Hdf5Type hdf5_type() {
  if constexpr (std::same_as<T, double>) {
    return Hdf5Type::kFloat64;
  } else if constexpr (std::same_as<T, float>) {
    return Hdf5Type::kFloat32;
  } else if constexpr (std::same_as<T, std::int64_t>) {
    return Hdf5Type::kInt64;
  } else if constexpr (std::same_as<T, std::int32_t>) {
    return Hdf5Type::kInt32;
  } else if constexpr (std::same_as<T, std::int16_t>) {
    return Hdf5Type::kInt16;
  } else {
    static_assert(std::same_as<T, std::uint8_t>);
    return Hdf5Type::kUint8;
  }
}

/// Extents of a dataset, rows first; in what a reader asks for, -1 takes any.
using Hdf5Shape = std::vector<std::int64_t>;

template <typename T>
using RowMajor3 = Eigen::Matrix<T, Eigen::Dynamic, 3, Eigen::RowMajor>;
template <typename T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The file's attribute that holds its digest.
inline constexpr const char* kDigestName = "content_sha256";

/// SHA-256 over the logical content, item by item (FORMAT.md, "Digest").
class ContentDigest {
 public:
  void add(std::string_view head, const void* data, std::size_t bytes);
  [[nodiscard]] std::string hex() const { return digest_.hex(); }

 private:
  Sha256 digest_;
};

/// Switches HDF5's error printing off for its lifetime.
class QuietHdf5 {
 public:
  QuietHdf5();
  ~QuietHdf5();
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  void* function_ = nullptr;
  void* data_ = nullptr;
};

/// Excludes all other use of HDF5 in the process, whose library is not thread-safe.
/// Whoever makes a reader or a writer holds one while it uses it. One thread can hold
/// several. HDF5's error printing is off meanwhile.
class Hdf5Lock {
 public:
  Hdf5Lock();

 private:
  std::lock_guard<std::recursive_mutex> guard_;
  QuietHdf5 quiet_;
};

/// The same, by hand, for hosts that use HDF5 themselves; they nest in one thread.
/// Their own error printing stays as it is.
void lock_hdf5();
void unlock_hdf5();

/// For programs that close all their files themselves, before their first use of HDF5:
/// switches its clean-up at exit off. After a damaged file HDF5 1.10 cannot finish it
/// and prints "infinite loop closing library" on stderr (known upstream; memory only).
void skip_hdf5_exit_cleanup() noexcept;

/// Makes a new file in memory: HDF5 1.10 can crash after a write that failed, for
/// example on a full disk. Every method @throws std::runtime_error if HDF5 fails all
/// the same.
class Hdf5Writer {
 public:
  static constexpr bool kWrites = true;

  /// Larger datasets are compressed if the options say so; their precision is that of
  /// reals().
  explicit Hdf5Writer(const StorageOptions& storage = {});
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  void group(const std::string& path);

  /// Creates the group if it is wanted. @return wanted
  bool optional_group(const std::string& path, bool wanted);

  /// @return wanted
  [[nodiscard]] bool optional_dataset(const std::string&, bool wanted) const {
    return wanted;
  }

  /// @return wanted
  [[nodiscard]] bool optional_attribute(const std::string&, const char*,
                                        bool wanted) const {
    return wanted;
  }

  void attribute(const std::string& object, const char* name, const std::string& value);
  void attribute(const std::string& object, const char* name, double value);
  void attribute(const std::string& object, const char* name, std::int64_t value);

  /// The CF convention's description of an enumeration, or of bits if `masks`.
  void flags(const std::string& dataset, const std::vector<std::uint8_t>& values,
             const char* meanings, bool masks);

  /// A text of any length, as a scalar dataset.
  void text(const std::string& path, const std::string& value);

  /// (rows): one value per row.
  template <typename T>
  void dataset(const std::string& path, const char* units,
               const std::vector<T>& values) {
    write(path, units, hdf5_type<T>(), values.data(),
          {static_cast<std::int64_t>(values.size())}, true);
  }

  /// (rows x 3)
  template <typename T>
  void dataset(const std::string& path, const char* units, const RowMajor3<T>& values) {
    write(path, units, hdf5_type<T>(), values.data(), {values.rows(), 3}, true);
  }

  /// (rows x columns)
  template <typename T>
  void dataset(const std::string& path, const char* units, const RowMajor<T>& values) {
    write(path, units, hdf5_type<T>(), values.data(), {values.rows(), values.cols()},
          true);
  }

  /// (nodes x 3 x columns) from a matrix (3 nodes x columns)
  template <typename T>
  void vectors(const std::string& path, const char* units, const RowMajor<T>& values) {
    write(path, units, hdf5_type<T>(), values.data(),
          {values.rows() / 3, 3, values.cols()}, true);
  }

  /// (rows) of samples, and begins of rows: as dataset().
  void samples(const std::string& path, const char* units,
               const std::vector<double>& values) {
    dataset(path, units, values);
  }
  void begins(const std::string& path, const std::vector<std::int64_t>& values) {
    dataset(path, "1", values);
  }

  /// (rows) in the precision of the options; scaled by node, which owns the rows
  /// [begin[i], begin[i + 1]). Digested in double precision, as they will be read.
  void reals(const std::string& path, const char* units,
             const std::vector<double>& values, const std::vector<std::int64_t>& begin);

  /// Slopes and energies, if the precision of the options keeps them; else they enter
  /// the digest alone. @return whether they are in the file
  [[nodiscard]] bool keeps_slopes(const std::string& /*path*/) const {
    return storage_.precision == Precision::kFloat64;
  }
  void digest_only(const std::string& path, const std::vector<double>& values);

  /// (rows), outside the digest: what follows from the rest of the content.
  template <typename T>
  void derived(const std::string& path, const char* units,
               const std::vector<T>& values) {
    write(path, units, hdf5_type<T>(), values.data(),
          {static_cast<std::int64_t>(values.size())}, false);
  }
  template <typename T>
  void derived(const std::string& path, const char* units, const RowMajor3<T>& values) {
    write(path, units, hdf5_type<T>(), values.data(), {values.rows(), 3}, false);
  }
  template <typename T>
  void derived(const std::string& path, const char* units, const RowMajor<T>& values) {
    write(path, units, hdf5_type<T>(), values.data(), {values.rows(), values.cols()},
          false);
  }

  /// An attribute outside the digest.
  void remark(const std::string& object, const char* name, const std::string& value);
  void remark(const std::string& object, const char* name, std::int64_t value);

  /// A second name for an object, outside the digest.
  void link(const std::string& path, const std::string& object);

  /// Type and version by which VTK recognises a group.
  void vtk_header(const std::string& group);

  [[nodiscard]] std::string digest() const { return digest_.hex(); }

  /// The bytes of the file; to be called last, valid as long as the writer.
  [[nodiscard]] std::span<const std::byte> image();

 private:
  void write(const std::string& path, const char* units, Hdf5Type type,
             const void* data, const Hdf5Shape& shape, bool digested);

  QuietHdf5 quiet_;
  StorageOptions storage_;
  std::int64_t id_ = -1;
  ContentDigest digest_;
};

}  // namespace palpate
