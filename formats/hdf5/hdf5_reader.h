// HDF5 files read behind C++: who reads one that is not its own holds it to types,
// shapes and sizes first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "formats/hdf5/hdf5_io.h"

namespace palpate {

/// Reads a file that may be foreign, damaged or hostile: types, shapes, units and sizes
/// are checked before anything is allocated. Every method @throws FormatError naming
/// the file, the dataset or attribute, what it is and what it must be.
class Hdf5Reader {
 public:
  static constexpr bool kWrites = false;

  /// @throws InputError if the file is missing or cannot be opened, FormatError if it
  /// is not HDF5 or is truncated.
  explicit Hdf5Reader(const std::filesystem::path& file);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  [[nodiscard]] bool has(const std::string& path) const;
  [[nodiscard]] bool has_attribute(const std::string& object, const char* name) const;

  void group(const std::string& path) const;
  [[nodiscard]] bool optional_group(const std::string& path, bool /*ignored*/) const {
    return has(path);
  }
  [[nodiscard]] bool optional_dataset(const std::string& path, bool /*ignored*/) const {
    return has(path);
  }
  [[nodiscard]] bool optional_attribute(const std::string& object, const char* name,
                                        bool /*ignored*/) const {
    return has_attribute(object, name);
  }

  void attribute(const std::string& object, const char* name, std::string& value);
  void attribute(const std::string& object, const char* name, double& value);
  void attribute(const std::string& object, const char* name, std::int64_t& value);

  /// Describes, does not decide: nothing to read.
  void flags(const std::string&, const std::vector<std::uint8_t>&, const char*,
             bool) const {}

  void text(const std::string& path, std::string& value);

  template <typename T>
  void dataset(const std::string& path, const char* units, std::vector<T>& values) {
    const Hdf5Shape shape = checked_shape(path, units, hdf5_type<T>(), {-1});
    allocate(path, shape, [&] {
      values.resize(static_cast<std::size_t>(shape[0]));
    });
    read(path, hdf5_type<T>(), values.data(), shape, true);
  }

  template <typename T>
  void dataset(const std::string& path, const char* units, RowMajor3<T>& values) {
    const Hdf5Shape shape = checked_shape(path, units, hdf5_type<T>(), {-1, 3});
    allocate(path, shape, [&] {
      values.resize(shape[0], 3);
    });
    read(path, hdf5_type<T>(), values.data(), shape, true);
  }

  template <typename T>
  void dataset(const std::string& path, const char* units, RowMajor<T>& values) {
    const Hdf5Shape shape = checked_shape(path, units, hdf5_type<T>(), {-1, -1});
    allocate(path, shape, [&] {
      values.resize(shape[0], shape[1]);
    });
    read(path, hdf5_type<T>(), values.data(), shape, true);
  }

  template <typename T>
  void vectors(const std::string& path, const char* units, RowMajor<T>& values) {
    const Hdf5Shape shape = checked_shape(path, units, hdf5_type<T>(), {-1, 3, -1});
    allocate(path, shape, [&] {
      values.resize(3 * shape[0], shape[2]);
    });
    read(path, hdf5_type<T>(), values.data(), shape, true);
  }

  void samples(const std::string& path, const char* units,
               std::vector<double>& values) {
    dataset(path, units, values);
  }
  void begins(const std::string& path, std::vector<std::int64_t>& values) {
    dataset(path, "1", values);
  }

  /// (rows) in any precision, as doubles.
  void reals(const std::string& path, const char* units, std::vector<double>& values,
             const std::vector<std::int64_t>& begin);
  [[nodiscard]] bool keeps_slopes(const std::string& path) const { return has(path); }
  void digest_only(const std::string& path, const std::vector<double>& values);

  /// Rows [begin, begin + count) of a dataset of any number of columns, outside the
  /// digest. @param columns 0 for one dimension
  void rows(const std::string& path, const char* units, Hdf5Type type,
            std::int64_t begin, std::int64_t count, std::int64_t columns,
            void* to) const;

  /// Reads values.size() rows from first_row on, as doubles, whatever their stored
  /// precision; they do not enter the digest.
  /// @param begin for int16 data: where each node's rows begin relative to first_row,
  /// the first entry being first_node's.
  void rows_as_reals(const std::string& path, const char* units, std::int64_t first_row,
                     std::int64_t first_node, const std::vector<std::int64_t>& begin,
                     std::vector<double>& values) const;

  /// Element type of a dataset. @throws FormatError if it is missing or another's.
  [[nodiscard]] Hdf5Type type_of(const std::string& path) const;

  /// Extent of a dataset of known type and units: nothing is read.
  [[nodiscard]] Hdf5Shape shape_of(const std::string& path, const char* units,
                                   Hdf5Type type, const Hdf5Shape& wanted) const {
    return checked_shape(path, units, type, wanted);
  }

  /// A text attribute outside the digest.
  [[nodiscard]] std::string remark(const std::string& object, const char* name) const {
    return read_text_attribute(object, name);
  }

  /// A whole number outside the digest.
  [[nodiscard]] std::int64_t remark_number(const std::string& object,
                                           const char* name) const;

  [[noreturn]] void fail(const std::string& what) const;

  /// Reads and compares. @throws FormatError also if the file says anything else.
  template <typename T>
  void derived(const std::string& path, const char* units,
               const std::vector<T>& expected) {
    const Hdf5Shape shape = checked_shape(path, units, hdf5_type<T>(), {-1});
    std::vector<T> values;
    allocate(path, shape, [&] {
      values.resize(static_cast<std::size_t>(shape[0]));
    });
    read(path, hdf5_type<T>(), values.data(), shape, false);
    if (values != expected) {
      fail("dataset " + path + " does not follow from the rest of the file");
    }
  }
  template <typename T, int kColumns>
  void derived(
      const std::string& path, const char* units,
      const Eigen::Matrix<T, Eigen::Dynamic, kColumns, Eigen::RowMajor>& expected) {
    const Hdf5Shape shape =
        checked_shape(path, units, hdf5_type<T>(), {-1, expected.cols()});
    RowMajor<T> values;
    allocate(path, shape, [&] {
      values.resize(shape[0], shape[1]);
    });
    read(path, hdf5_type<T>(), values.data(), shape, false);
    if (values.rows() != expected.rows() || values != expected) {
      fail("dataset " + path + " does not follow from the rest of the file");
    }
  }

  /// Requires that both paths name one object.
  void link(const std::string& path, const std::string& object) const;
  void vtk_header(const std::string& group) const;

  [[nodiscard]] std::string digest() const { return digest_.hex(); }

 private:
  // Memory for what a file claims to hold: where there is none, the error names the
  // file.
  template <typename Resize>
  void allocate(const std::string& path, const Hdf5Shape& shape, Resize resize) const {
    try {
      resize();
    } catch (const std::bad_alloc&) {
      fail_of_memory(path, shape);
    }
  }
  [[noreturn]] void fail_of_memory(const std::string& path,
                                   const Hdf5Shape& shape) const;

  [[nodiscard]] Hdf5Shape checked_shape(const std::string& path, const char* units,
                                        Hdf5Type type, const Hdf5Shape& wanted) const;
  void read(const std::string& path, Hdf5Type type, void* to, const Hdf5Shape& shape,
            bool digested);
  [[nodiscard]] std::string read_text_attribute(const std::string& object,
                                                const char* name) const;
  template <typename T>
  void read_number(const std::string& object, const char* name, T& value) const;

  // What rows() has checked and opened stays open: readers of chunks come back to it.
  struct Kept;
  [[nodiscard]] const Kept& kept(const std::string& path, const char* units,
                                 Hdf5Type type, std::int64_t columns) const;

  std::filesystem::path file_;
  std::int64_t id_ = -1;
  std::uint64_t bytes_ = 0;  // size of the file: nothing in it can be larger
  ContentDigest digest_;
  mutable std::map<std::string, std::unique_ptr<const Kept>> kept_;
};

}  // namespace palpate
