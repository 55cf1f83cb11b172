#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "formats/hdf5/hdf5_file.h"
#include "formats/hdf5/hdf5_handle.h"
#include "formats/hdf5/hdf5_lock.h"

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
void compress(hid_t create, const StoredShape& shape, std::size_t row_bytes) {
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

class Hdf5Sink final : public StoredSink {
 public:
  explicit Hdf5Sink(bool compressed);
  ~Hdf5Sink() override {
    const Hdf5Lock lock;
    id_.reset();
  }

  void group(const std::string& path) override;
  void text_attribute(const std::string& object, const char* name,
                      std::string_view value) override;
  void number_attribute(const std::string& object, const char* name, StoredType type,
                        const void* value) override;
  void bytes_attribute(const std::string& object, const char* name,
                       std::span<const std::uint8_t> values) override;
  void text(const std::string& path, std::string_view value) override;
  void dataset(const std::string& path, StoredType type, const StoredShape& shape,
               const void* data) override;
  [[nodiscard]] bool shows_vtk() const override { return true; }
  void link(const std::string& path, const std::string& object) override;
  void vtk_header(const std::string& group) override;
  [[nodiscard]] std::span<const std::byte> image() override;

 private:
  bool compressed_;
  std::optional<Handle> id_;
};

Hdf5Sink::Hdf5Sink(bool compressed) : compressed_(compressed) {
  const Hdf5Lock lock;
  constexpr std::size_t kGrowth = std::size_t{1} << 20;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kGrowth, false);
  // The layout of HDF5 1.8 puts a checksum on every piece of metadata.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  const Handle create = creation_properties(H5P_FILE_CREATE);
  // HDF5 tells open files apart by name; this one names no file.
  const std::string name = fmt::format("in memory {}", fmt::ptr(this));
  id_.emplace(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, create.get(), access.get()),
              H5Fclose);
  require_written(static_cast<bool>(*id_), "/");
}

void Hdf5Sink::group(const std::string& path) {
  const Hdf5Lock lock;
  const Handle create = creation_properties(H5P_GROUP_CREATE);
  const Handle made(
      H5Gcreate2(id_->get(), path.c_str(), H5P_DEFAULT, create.get(), H5P_DEFAULT),
      H5Gclose);
  require_written(static_cast<bool>(made), path);
}

void Hdf5Sink::text_attribute(const std::string& object, const char* name,
                              std::string_view value) {
  const Hdf5Lock lock;
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type = hdf5::string_type(value.size());
  require_written(put_attribute(id_->get(), object, name, type.get(),
                                value.empty() ? "" : value.data(), space.get()),
                  object + "@" + name);
}

void Hdf5Sink::number_attribute(const std::string& object, const char* name,
                                StoredType type, const void* value) {
  const Hdf5Lock lock;
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  require_written(put_attribute(id_->get(), object, name, hdf5::file_type(type), value,
                                space.get()),
                  object + "@" + name);
}

void Hdf5Sink::bytes_attribute(const std::string& object, const char* name,
                               std::span<const std::uint8_t> values) {
  const Hdf5Lock lock;
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  require_written(
      put_attribute(id_->get(), object, name, H5T_STD_U8LE, values.data(), space.get()),
      object + "@" + name);
}

void Hdf5Sink::text(const std::string& path, std::string_view value) {
  const Hdf5Lock lock;
  const Handle type = hdf5::string_type(value.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle create = creation_properties(H5P_DATASET_CREATE);
  const Handle made(H5Dcreate2(id_->get(), path.c_str(), type.get(), space.get(),
                               H5P_DEFAULT, create.get(), H5P_DEFAULT),
                    H5Dclose);
  require_written(made && H5Dwrite(made.get(), type.get(), H5S_ALL, H5S_ALL,
                                   H5P_DEFAULT, value.empty() ? "" : value.data()) >= 0,
                  path);
}

void Hdf5Sink::dataset(const std::string& path, StoredType type,
                       const StoredShape& shape, const void* data) {
  const Hdf5Lock lock;
  const std::vector<hsize_t> size(shape.begin(), shape.end());
  const Handle space(
      H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  const Handle create = creation_properties(H5P_DATASET_CREATE);
  const std::size_t values = values_in(shape);
  // Small ones would grow by the tables of their pieces.
  constexpr std::size_t kWorthwhile = 4096;
  if (compressed_ && values * bytes_of(type) >= kWorthwhile) {
    compress(create.get(), shape,
             values / static_cast<std::size_t>(shape.front()) * bytes_of(type));
  }
  const hid_t stored = hdf5::file_type(type);
  const Handle made(H5Dcreate2(id_->get(), path.c_str(), stored, space.get(),
                               H5P_DEFAULT, create.get(), H5P_DEFAULT),
                    H5Dclose);
  require_written(static_cast<bool>(made), path);
  require_written(values == 0 || H5Dwrite(made.get(), stored, H5S_ALL, H5S_ALL,
                                          H5P_DEFAULT, data) >= 0,
                  path);
}

void Hdf5Sink::link(const std::string& path, const std::string& object) {
  const Hdf5Lock lock;
  require_written(H5Lcreate_hard(id_->get(), object.c_str(), id_->get(), path.c_str(),
                                 H5P_DEFAULT, H5P_DEFAULT) >= 0,
                  path);
}

void Hdf5Sink::vtk_header(const std::string& group) {
  const Hdf5Lock lock;
  const Handle space(H5Screate_simple(1, &hdf5::kVtkVersionSize, nullptr), H5Sclose);
  require_written(put_attribute(id_->get(), group, "Version", H5T_STD_I64LE,
                                hdf5::kVtkVersion.data(), space.get()),
                  group + "@Version");
  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);  // VTK 9.1 knows ASCII only
  H5Tset_size(type.get(), std::strlen(hdf5::kVtkType));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  require_written(put_attribute(id_->get(), group, "Type", type.get(), hdf5::kVtkType,
                                scalar.get()),
                  group + "@Type");
}

std::span<const std::byte> Hdf5Sink::image() {
  const Hdf5Lock lock;
  require_written(H5Fflush(id_->get(), H5F_SCOPE_GLOBAL) >= 0, "/");
  // Only the size of the image: its copy clears superblock flags, but leaves the
  // checksum over them. So the bytes are those of the driver's own memory.
  const ssize_t size = H5Fget_file_image(id_->get(), nullptr, 0);
  void* memory = nullptr;
  require_written(size > 0 && H5Fget_vfd_handle(id_->get(), H5P_DEFAULT, &memory) >= 0,
                  "/");
  const void* bytes = *static_cast<void**>(memory);
  return {static_cast<const std::byte*>(bytes), static_cast<std::size_t>(size)};
}

}  // namespace

std::unique_ptr<StoredSink> make_hdf5_sink(bool compress) {
  return std::make_unique<Hdf5Sink>(compress);
}

}  // namespace palpate
