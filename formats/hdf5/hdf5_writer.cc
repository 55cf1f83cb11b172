#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "formats/hdf5/hdf5_handle.h"
#include "formats/hdf5/hdf5_io.h"

namespace palpate {
namespace {

using hdf5::Handle;

// Links and attributes up to this many stay in the object header, under its checksum.
constexpr unsigned kCompactEntries = 64;

// In memory HDF5 fails only for want of memory, or for a mistake of ours.
void require_written(bool done, const std::string& item) {
  if (!done) {
    throw std::runtime_error(
        fmt::format("HDF5 cannot write {}: {}", item, hdf5::last_failure()));
  }
}

Handle creation_properties(hid_t kind) {
  Handle properties(H5Pcreate(kind), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  H5Pset_attr_phase_change(properties.get(), kCompactEntries, 0);
  if (kind != H5P_DATASET_CREATE) {
    H5Pset_link_phase_change(properties.get(), kCompactEntries, 0);
  }
  return properties;
}

// Splits rows into pieces of about 128 KiB, each shuffled and deflated.
void compress(hid_t create, const Hdf5Shape& shape, std::size_t row_bytes) {
  constexpr std::size_t kPiece = std::size_t{1} << 17;
  constexpr unsigned kLevel = 4;
  std::vector<hsize_t> piece(shape.begin(), shape.end());
  piece.front() = std::clamp<hsize_t>(kPiece / row_bytes, 1, piece.front());
  H5Pset_chunk(create, static_cast<int>(piece.size()), piece.data());
  H5Pset_shuffle(create);
  H5Pset_deflate(create, kLevel);
}

// Creates an attribute of any type on an object.
bool put_attribute(hid_t file, const std::string& object, const char* name,
                   hid_t stored, const void* value, hid_t space) {
  const Handle attribute(H5Acreate_by_name(file, object.c_str(), name, stored, space,
                                           H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  return attribute && H5Awrite(attribute.get(), stored, value) >= 0;
}

bool put_text_attribute(hid_t file, const std::string& object, const char* name,
                        std::string_view value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type = hdf5::string_type(value.size());
  return put_attribute(file, object, name, type.get(),
                       value.empty() ? "" : value.data(), space.get());
}

}  // namespace

Hdf5Writer::Hdf5Writer(const StorageOptions& storage) : storage_(storage) {
  constexpr std::size_t kGrowth = std::size_t{1} << 20;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kGrowth, false);
  // The layout of HDF5 1.8 puts a checksum on every piece of metadata.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  const Handle create = creation_properties(H5P_FILE_CREATE);
  // HDF5 tells open files apart by name; this one names no file.
  const std::string name = fmt::format("in memory {}", fmt::ptr(this));
  id_ = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, create.get(), access.get());
  require_written(id_ >= 0, "/");
}

Hdf5Writer::~Hdf5Writer() {
  if (id_ >= 0) {
    H5Fclose(id_);
  }
}

void Hdf5Writer::group(const std::string& path) {
  const Handle create = creation_properties(H5P_GROUP_CREATE);
  const Handle made(
      H5Gcreate2(id_, path.c_str(), H5P_DEFAULT, create.get(), H5P_DEFAULT), H5Gclose);
  require_written(static_cast<bool>(made), path);
}

bool Hdf5Writer::optional_group(const std::string& path, bool wanted) {
  if (wanted) {
    group(path);
  }
  return wanted;
}

void Hdf5Writer::attribute(const std::string& object, const char* name,
                           const std::string& value) {
  remark(object, name, value);
  digest_.add(hdf5::digest_head(object + "@" + name, "text",
                                static_cast<std::int64_t>(value.size()), 0),
              value.data(), value.size());
}

void Hdf5Writer::attribute(const std::string& object, const char* name, double value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  require_written(put_attribute(id_, object, name, H5T_IEEE_F64LE, &value, space.get()),
                  object + "@" + name);
  digest_.add(hdf5::digest_head(object + "@" + name, "float64", 1, 0), &value,
              sizeof value);
}

void Hdf5Writer::attribute(const std::string& object, const char* name,
                           std::int64_t value) {
  remark(object, name, value);
  digest_.add(hdf5::digest_head(object + "@" + name, "int64", 1, 0), &value,
              sizeof value);
}

void Hdf5Writer::flags(const std::string& dataset,
                       const std::vector<std::uint8_t>& values, const char* meanings,
                       bool masks) {
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  bool done = put_attribute(id_, dataset, "flag_values", H5T_STD_U8LE, values.data(),
                            space.get());
  if (masks) {
    done = done && put_attribute(id_, dataset, "flag_masks", H5T_STD_U8LE,
                                 values.data(), space.get());
  }
  require_written(done && put_text_attribute(id_, dataset, "flag_meanings", meanings),
                  dataset + "@flag_meanings");
}

void Hdf5Writer::text(const std::string& path, const std::string& value) {
  const Handle type = hdf5::string_type(value.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle create = creation_properties(H5P_DATASET_CREATE);
  const Handle made(H5Dcreate2(id_, path.c_str(), type.get(), space.get(), H5P_DEFAULT,
                               create.get(), H5P_DEFAULT),
                    H5Dclose);
  require_written(made && H5Dwrite(made.get(), type.get(), H5S_ALL, H5S_ALL,
                                   H5P_DEFAULT, value.c_str()) >= 0,
                  path);
  digest_.add(
      hdf5::digest_head(path, "text", static_cast<std::int64_t>(value.size()), 0),
      value.data(), value.size());
}

void Hdf5Writer::write(const std::string& path, const char* units, Hdf5Type type,
                       const void* data, const Hdf5Shape& shape, bool digested) {
  const std::vector<hsize_t> size(shape.begin(), shape.end());
  const Handle space(
      H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  const Handle create = creation_properties(H5P_DATASET_CREATE);
  const std::size_t values = hdf5::values_in(shape);
  // Small ones would grow by the tables of their pieces.
  constexpr std::size_t kWorthwhile = 4096;
  if (storage_.compress && values * hdf5::bytes_of(type) >= kWorthwhile) {
    compress(create.get(), shape,
             values / static_cast<std::size_t>(shape.front()) * hdf5::bytes_of(type));
  }
  const hid_t stored = hdf5::file_type(type);
  const Handle made(H5Dcreate2(id_, path.c_str(), stored, space.get(), H5P_DEFAULT,
                               create.get(), H5P_DEFAULT),
                    H5Dclose);
  require_written(static_cast<bool>(made), path);
  require_written(values == 0 || H5Dwrite(made.get(), stored, H5S_ALL, H5S_ALL,
                                          H5P_DEFAULT, data) >= 0,
                  path);
  require_written(put_text_attribute(id_, path, "units", units), path + "@units");
  if (digested) {
    digest_.add(hdf5::digest_head(path, hdf5::name_of(type), shape.front(),
                                  hdf5::columns_of(shape)),
                data, values * hdf5::bytes_of(type));
  }
}

void Hdf5Writer::remark(const std::string& object, const char* name,
                        const std::string& value) {
  require_written(put_text_attribute(id_, object, name, value), object + "@" + name);
}

void Hdf5Writer::remark(const std::string& object, const char* name,
                        std::int64_t value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  require_written(put_attribute(id_, object, name, H5T_STD_I64LE, &value, space.get()),
                  object + "@" + name);
}

void Hdf5Writer::link(const std::string& path, const std::string& object) {
  require_written(H5Lcreate_hard(id_, object.c_str(), id_, path.c_str(), H5P_DEFAULT,
                                 H5P_DEFAULT) >= 0,
                  path);
}

void Hdf5Writer::vtk_header(const std::string& group) {
  const Handle space(H5Screate_simple(1, &hdf5::kVtkVersionSize, nullptr), H5Sclose);
  require_written(put_attribute(id_, group, "Version", H5T_STD_I64LE,
                                hdf5::kVtkVersion.data(), space.get()),
                  group + "@Version");
  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);  // VTK 9.1 knows ASCII only
  H5Tset_size(type.get(), std::strlen(hdf5::kVtkType));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  require_written(
      put_attribute(id_, group, "Type", type.get(), hdf5::kVtkType, scalar.get()),
      group + "@Type");
}

std::span<const std::byte> Hdf5Writer::image() {
  require_written(H5Fflush(id_, H5F_SCOPE_GLOBAL) >= 0, "/");
  // Only the size of the image: its copy clears superblock flags, but leaves the
  // checksum over them. So the bytes are those of the driver's own memory.
  const ssize_t size = H5Fget_file_image(id_, nullptr, 0);
  void* memory = nullptr;
  require_written(size > 0 && H5Fget_vfd_handle(id_, H5P_DEFAULT, &memory) >= 0, "/");
  const void* bytes = *static_cast<void**>(memory);
  return {static_cast<const std::byte*>(bytes), static_cast<std::size_t>(size)};
}

}  // namespace palpate
