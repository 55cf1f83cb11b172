// Files read behind C++, whatever their form: who reads one that is not its own holds
// it to types, shapes and sizes first.
//
// StoredWriter and StoredReader have the same methods. So one template states for both
// what a file holds and in which order.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "formats/stored/content_digest.h"
#include "formats/stored/stored_file.h"

namespace palpate {

/// Reads a file that may be foreign, damaged or hostile: types, shapes, units and sizes
/// are checked before anything is allocated. Every method @throws FormatError naming
/// the file, the dataset or attribute, what it is and what it must be.
class StoredReader {
 public:
  static constexpr bool kWrites = false;

  explicit StoredReader(std::unique_ptr<const StoredFile> file)
      : file_(std::move(file)) {}

  /// Of the file alone: its name, its form, its size, and who may use it.
  [[nodiscard]] const StoredFile& file() const noexcept { return *file_; }

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
    const Checked found = checked(path, units, stored_type<T>(), {-1});
    allocate(path, found.shape, [&] {
      values.resize(static_cast<std::size_t>(found.shape[0]));
    });
    read(path, found, values.data(), true);
  }

  template <typename T>
  void dataset(const std::string& path, const char* units, RowMajor3<T>& values) {
    const Checked found = checked(path, units, stored_type<T>(), {-1, 3});
    allocate(path, found.shape, [&] {
      values.resize(found.shape[0], 3);
    });
    read(path, found, values.data(), true);
  }

  template <typename T>
  void dataset(const std::string& path, const char* units, RowMajor<T>& values) {
    const Checked found = checked(path, units, stored_type<T>(), {-1, -1});
    allocate(path, found.shape, [&] {
      values.resize(found.shape[0], found.shape[1]);
    });
    read(path, found, values.data(), true);
  }

  template <typename T>
  void vectors(const std::string& path, const char* units, RowMajor<T>& values) {
    const Checked found = checked(path, units, stored_type<T>(), {-1, 3, -1});
    allocate(path, found.shape, [&] {
      values.resize(3 * found.shape[0], found.shape[2]);
    });
    read(path, found, values.data(), true);
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
  void digest_only(const std::string& path, const std::vector<double>& values) {
    digest_.add_reals(path, values);
  }

  /// Rows [begin, begin + count) of a dataset of any number of columns, outside the
  /// digest. @param columns 0 for one dimension
  void rows(const std::string& path, const char* units, StoredType type,
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
  [[nodiscard]] StoredType type_of(const std::string& path) const;

  /// Extent of a dataset of known type and units: nothing is read.
  [[nodiscard]] StoredShape shape_of(const std::string& path, const char* units,
                                     StoredType type, const StoredShape& wanted) const {
    return checked(path, units, type, wanted).shape;
  }

  /// A text attribute outside the digest.
  [[nodiscard]] std::string remark(const std::string& object, const char* name) const;

  /// A whole number outside the digest.
  [[nodiscard]] std::int64_t remark_number(const std::string& object,
                                           const char* name) const;

  [[noreturn]] void fail(const std::string& what) const { file_->fail(what); }

  /// Reads and compares. @throws FormatError also if the file says anything else.
  template <typename T>
  void derived(const std::string& path, const char* units,
               const std::vector<T>& expected) {
    const Checked found = checked(path, units, stored_type<T>(), {-1});
    std::vector<T> values;
    allocate(path, found.shape, [&] {
      values.resize(static_cast<std::size_t>(found.shape[0]));
    });
    read(path, found, values.data(), false);
    if (values != expected) {
      fail("dataset " + path + " does not follow from the rest of the file");
    }
  }
  template <typename T, int kColumns>
  void derived(
      const std::string& path, const char* units,
      const Eigen::Matrix<T, Eigen::Dynamic, kColumns, Eigen::RowMajor>& expected) {
    const Checked found = checked(path, units, stored_type<T>(), {-1, expected.cols()});
    RowMajor<T> values;
    allocate(path, found.shape, [&] {
      values.resize(found.shape[0], found.shape[1]);
    });
    read(path, found, values.data(), false);
    if (values.rows() != expected.rows() || values != expected) {
      fail("dataset " + path + " does not follow from the rest of the file");
    }
  }

  /// As StoredFile::shows_vtk().
  [[nodiscard]] bool shows_vtk() const { return file_->shows_vtk(); }
  /// Requires that both paths name one object.
  void link(const std::string& path, const std::string& object) const;
  void vtk_header(const std::string& group) const;

  [[nodiscard]] std::string digest() const { return digest_.hex(); }

 private:
  // A dataset stays open: readers of chunks come back to it.
  struct Kept {
    std::unique_ptr<const StoredDataset> dataset;
    bool whole = false;      // its bytes were looked for
    std::string units = {};  // as it has them; empty: nobody looked
  };
  struct Checked {
    const StoredDataset& dataset;
    StoredType type;
    StoredShape shape;
  };

  // Memory for what a file claims to hold: where there is none, the error names the
  // file.
  template <typename Resize>
  void allocate(const std::string& path, const StoredShape& shape,
                Resize resize) const {
    try {
      resize();
    } catch (const std::bad_alloc&) {
      fail_of_memory(path, shape);
    }
  }
  [[noreturn]] void fail_of_memory(const std::string& path,
                                   const StoredShape& shape) const;
  void require_attribute(const std::string& object, const char* name) const;
  void require_dataset(const std::string& path) const;
  template <typename T>
  void read_number(const std::string& object, const char* name, T& value) const;
  [[nodiscard]] Kept& kept(const std::string& path) const;
  [[nodiscard]] Checked checked(const std::string& path, const char* units,
                                StoredType type, const StoredShape& wanted) const;
  void read(const std::string& path, const Checked& found, void* to, bool digested);

  std::unique_ptr<const StoredFile> file_;
  ContentDigest digest_;
  mutable std::map<std::string, Kept> kept_;  // closed before the file
};

}  // namespace palpate
