// Files written from C++, whatever their form: flat datasets with a unit, small
// attributes, and a digest of everything that passes through.
//
// StoredWriter and StoredReader have the same methods. So one template states for both
// what a file holds and in which order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/stored/content_digest.h"
#include "formats/stored/storage_options.h"
#include "formats/stored/stored_sink.h"

namespace palpate {

/// Makes a new file in memory, in the form of its sink.
class StoredWriter {
 public:
  static constexpr bool kWrites = true;

  /// @param precision that of reals()
  explicit StoredWriter(std::unique_ptr<StoredSink> sink,
                        Precision precision = Precision::kFloat64)
      : sink_(std::move(sink)), precision_(precision) {}

  void group(const std::string& path) { sink_->group(path); }

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
    write(path, units, stored_type<T>(), values.data(),
          {static_cast<std::int64_t>(values.size())}, true);
  }

  /// (rows x 3)
  template <typename T>
  void dataset(const std::string& path, const char* units, const RowMajor3<T>& values) {
    write(path, units, stored_type<T>(), values.data(), {values.rows(), 3}, true);
  }

  /// (rows x columns)
  template <typename T>
  void dataset(const std::string& path, const char* units, const RowMajor<T>& values) {
    write(path, units, stored_type<T>(), values.data(), {values.rows(), values.cols()},
          true);
  }

  /// (nodes x 3 x columns) from a matrix (3 nodes x columns)
  template <typename T>
  void vectors(const std::string& path, const char* units, const RowMajor<T>& values) {
    write(path, units, stored_type<T>(), values.data(),
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
    return precision_ == Precision::kFloat64;
  }
  void digest_only(const std::string& path, const std::vector<double>& values) {
    digest_.add_reals(path, values);
  }

  /// (rows), outside the digest: what follows from the rest of the content.
  template <typename T>
  void derived(const std::string& path, const char* units,
               const std::vector<T>& values) {
    write(path, units, stored_type<T>(), values.data(),
          {static_cast<std::int64_t>(values.size())}, false);
  }
  template <typename T>
  void derived(const std::string& path, const char* units, const RowMajor3<T>& values) {
    write(path, units, stored_type<T>(), values.data(), {values.rows(), 3}, false);
  }
  template <typename T>
  void derived(const std::string& path, const char* units, const RowMajor<T>& values) {
    write(path, units, stored_type<T>(), values.data(), {values.rows(), values.cols()},
          false);
  }

  /// An attribute outside the digest.
  void remark(const std::string& object, const char* name, const std::string& value);
  void remark(const std::string& object, const char* name, std::int64_t value);

  /// As StoredSink has them, outside the digest.
  [[nodiscard]] bool shows_vtk() const { return sink_->shows_vtk(); }
  void link(const std::string& path, const std::string& object) {
    sink_->link(path, object);
  }
  void vtk_header(const std::string& group) { sink_->vtk_header(group); }

  [[nodiscard]] std::string digest() const { return digest_.hex(); }

  /// The bytes of the file; to be called last, valid as long as the writer.
  [[nodiscard]] std::span<const std::byte> image() { return sink_->image(); }

 private:
  void write(const std::string& path, const char* units, StoredType type,
             const void* data, const StoredShape& shape, bool digested);

  std::unique_ptr<StoredSink> sink_;
  Precision precision_;
  ContentDigest digest_;
};

}  // namespace palpate
