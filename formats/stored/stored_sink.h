// Where a writer of databases puts what it writes, whatever the form: HDF5 or flat.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "formats/stored/stored_type.h"

namespace palpate {

/// A new file in memory. The order of the calls is the order in the file; a group comes
/// before what is in it, an object before its attributes. Equal calls give equal bytes.
class StoredSink {
 public:
  StoredSink() = default;
  virtual ~StoredSink() = default;
  StoredSink(const StoredSink&) = delete;
  StoredSink& operator=(const StoredSink&) = delete;

  virtual void group(const std::string& path) = 0;
  virtual void text_attribute(const std::string& object, const char* name,
                              std::string_view value) = 0;
  /// One number.
  virtual void number_attribute(const std::string& object, const char* name,
                                StoredType type, const void* value) = 0;
  virtual void bytes_attribute(const std::string& object, const char* name,
                               std::span<const std::uint8_t> values) = 0;
  /// A text of any length.
  virtual void text(const std::string& path, std::string_view value) = 0;
  /// @param data values_in(shape) values
  virtual void dataset(const std::string& path, StoredType type,
                       const StoredShape& shape, const void* data) = 0;

  /// As StoredFile::shows_vtk(); a second name for an object, and VTK's own header of a
  /// group.
  [[nodiscard]] virtual bool shows_vtk() const { return false; }
  virtual void link(const std::string& /*path*/, const std::string& /*object*/) {}
  virtual void vtk_header(const std::string& /*group*/) {}

  /// The bytes of the file; to be called last, valid as long as the sink.
  [[nodiscard]] virtual std::span<const std::byte> image() = 0;
};

}  // namespace palpate
