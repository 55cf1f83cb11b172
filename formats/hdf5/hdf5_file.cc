#include "formats/hdf5/hdf5_file.h"

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "formats/base/believed_bytes.h"
#include "formats/base/utf8_path.h"
#include "formats/hdf5/hdf5_handle.h"
#include "formats/hdf5/hdf5_lock.h"

namespace palpate {
namespace {

using hdf5::Handle;

bool is_scalar(hid_t space) {
  return H5Sget_simple_extent_type(space) == H5S_SCALAR;
}

// A fixed-length string; variable-length ones point into the file and are not read.
bool is_fixed_text(hid_t type) {
  return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
}

std::optional<StoredType> stored_type_of(hid_t type) {
  for (const StoredType known :
       {StoredType::kFloat64, StoredType::kFloat32, StoredType::kInt64,
        StoredType::kInt32, StoredType::kInt16, StoredType::kUint8}) {
    if (H5Tequal(type, hdf5::file_type(known)) > 0) {
      return known;
    }
  }
  return std::nullopt;
}

StoredClaim claim_of(hid_t type, hid_t space) {
  StoredClaim claim{.type = stored_type_of(type)};
  const int rank = H5Sget_simple_extent_ndims(space);
  std::array<hsize_t, H5S_MAX_RANK> size{};
  claim.scalar = rank == 0;
  claim.array = rank > 0 && rank <= H5S_MAX_RANK &&
                H5Sget_simple_extent_dims(space, size.data(), nullptr) >= 0;
  if (claim.array) {
    claim.extent.assign(size.begin(), size.begin() + rank);
  }
  return claim;
}

// Where the raw bytes of a dataset lie. Other filters and files are not read: their
// code is not ours to trust.
enum class Layout { kContiguous, kCompressed, kForeign };

Layout layout_of(hid_t dataset) {
  const Handle create(H5Dget_create_plist(dataset), H5Pclose);
  if (!create || H5Pget_external_count(create.get()) != 0) {
    return Layout::kForeign;
  }
  if (H5Pget_layout(create.get()) == H5D_CONTIGUOUS) {
    return Layout::kContiguous;
  }
  if (H5Pget_layout(create.get()) != H5D_CHUNKED) {
    return Layout::kForeign;
  }
  const int filters = H5Pget_nfilters(create.get());
  for (int i = 0; i < filters; ++i) {
    std::size_t values = 0;
    unsigned flags = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(create.get(), static_cast<unsigned>(i), &flags, &values, nullptr,
                       0, nullptr, nullptr);
    if (filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_DEFLATE) {
      return Layout::kForeign;
    }
  }
  return filters > 0 ? Layout::kCompressed : Layout::kForeign;
}

class Hdf5File;

class Hdf5Dataset final : public StoredDataset {
 public:
  Hdf5Dataset(const Hdf5File& file, std::string path, Handle opened, StoredClaim claim)
      : StoredDataset(std::move(claim)),
        file_(file),
        path_(std::move(path)),
        opened_(std::move(opened)) {}
  ~Hdf5Dataset() override {
    const Hdf5Lock lock;
    opened_.reset();
  }

  void require_bytes() const override;
  void read(std::int64_t begin, std::int64_t count, void* to) const override;

 private:
  void require_room(std::uint64_t bytes, std::uint64_t inflation) const;

  const Hdf5File& file_;
  std::string path_;
  std::optional<Handle> opened_;
};

class Hdf5File final : public StoredFile {
 public:
  // @param open gives the file's identifier, negative where HDF5 refuses it
  template <typename Open>
  Hdf5File(std::string name, std::uint64_t bytes, std::uint64_t believed,
           const Open& open)
      : StoredFile(std::move(name)), bytes_(bytes), believed_(believed) {
    const Hdf5Lock lock;
    id_.emplace(open(), H5Fclose);
    if (!*id_) {
      fail(fmt::format("is truncated or damaged ({} bytes): {}", bytes_,
                       hdf5::last_failure()));
    }
  }
  ~Hdf5File() override {
    const Hdf5Lock lock;
    id_.reset();
  }

  [[nodiscard]] const char* form() const override { return "an HDF5 file"; }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }
  [[nodiscard]] std::uint64_t believed() const { return believed_; }
  [[nodiscard]] std::recursive_mutex& mutex() const override { return hdf5_mutex(); }

  [[nodiscard]] StoredLink link_at(const std::string& path) const override;
  void require_group(const std::string& path) const override;
  [[nodiscard]] bool has_attribute(const std::string& object,
                                   const char* name) const override;
  [[nodiscard]] std::optional<std::string> text_attribute(
      const std::string& object, const char* name) const override;
  [[nodiscard]] bool number_attribute(const std::string& object, const char* name,
                                      StoredType type, void* to) const override;
  [[nodiscard]] std::optional<std::string> text(const std::string& path) const override;
  [[nodiscard]] std::unique_ptr<const StoredDataset> dataset(
      const std::string& path) const override;

  [[nodiscard]] bool shows_vtk() const override { return true; }
  [[nodiscard]] bool same_object(const std::string& path,
                                 const std::string& other) const override;
  [[nodiscard]] bool has_vtk_header(const std::string& group) const override;

 private:
  [[nodiscard]] Handle attribute(const std::string& object, const char* name) const {
    return {H5Aopen_by_name(id_->get(), object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose};
  }

  std::optional<Handle> id_;
  std::uint64_t bytes_;
  std::uint64_t believed_;  // nothing in the file can be larger
};

void Hdf5Dataset::require_room(std::uint64_t bytes, std::uint64_t inflation) const {
  std::uint64_t most = bytes * inflation / bytes_of(*claim().type);
  for (const std::uint64_t size : claim().extent) {
    if (size > most) {
      file_.fail(
          fmt::format("dataset {} claims {} rows, more than a file of {} bytes can "
                      "hold",
                      path_, claim().extent.front(), bytes));
    }
    most /= std::max<std::uint64_t>(1, size);
  }
}

void Hdf5Dataset::require_bytes() const {
  const Hdf5Lock lock;
  const Layout layout = layout_of(opened_->get());
  if (layout == Layout::kForeign) {
    file_.fail(
        fmt::format("dataset {} is external or filtered, must be contiguous, or "
                    "shuffled and deflated",
                    path_));
  }
  const std::uint64_t inflation = layout == Layout::kCompressed ? kInflation : 1;
  require_room(file_.believed(), inflation);
  // What is small is not worth a look: rows that were never written are zeros.
  constexpr std::uint64_t kFree = 1 << 20;
  const StoredShape shape(claim().extent.begin(), claim().extent.end());
  if (values_in(shape) * bytes_of(*claim().type) > kFree) {
    if (!hdf5::holds_its_bytes(opened_->get())) {
      file_.fail(fmt::format("dataset {} claims {} rows that were never written", path_,
                             shape.front()));
    }
    require_room(
        std::min<std::uint64_t>(file_.believed(), H5Dget_storage_size(opened_->get())),
        inflation);
  }
}

void Hdf5Dataset::read(std::int64_t begin, std::int64_t count, void* to) const {
  const Hdf5Lock lock;
  // Rows [begin, begin + count) of the file, all columns, to as many rows in memory.
  std::vector<hsize_t> size(claim().extent.begin(), claim().extent.end());
  std::vector<hsize_t> start(size.size());
  size.front() = static_cast<hsize_t>(count);
  start.front() = static_cast<hsize_t>(begin);
  const Handle there(H5Dget_space(opened_->get()), H5Sclose);
  const Handle here(
      H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  if (!there ||
      H5Sselect_hyperslab(there.get(), H5S_SELECT_SET, start.data(), nullptr,
                          size.data(), nullptr) < 0 ||
      H5Dread(opened_->get(), hdf5::file_type(*claim().type), here.get(), there.get(),
              H5P_DEFAULT, to) < 0) {
    file_.fail(
        fmt::format("dataset {} cannot be read: {}", path_, hdf5::last_failure()));
  }
}

StoredLink Hdf5File::link_at(const std::string& path) const {
  const Hdf5Lock lock;
  switch (hdf5::link_at(id_->get(), path)) {
    case hdf5::Link::kNone:
      return StoredLink::kNone;
    case hdf5::Link::kHard:
      return StoredLink::kObject;
    case hdf5::Link::kOther:
      break;
  }
  return StoredLink::kElsewhere;
}

void Hdf5File::require_group(const std::string& path) const {
  const Hdf5Lock lock;
  const Handle opened(H5Gopen2(id_->get(), path.c_str(), H5P_DEFAULT), H5Gclose);
  if (!opened) {
    fail(fmt::format("{} cannot be opened as a group: {}", path, hdf5::last_failure()));
  }
}

bool Hdf5File::has_attribute(const std::string& object, const char* name) const {
  const Hdf5Lock lock;
  return H5Aexists_by_name(id_->get(), object.c_str(), name, H5P_DEFAULT) > 0;
}

std::optional<std::string> Hdf5File::text_attribute(const std::string& object,
                                                    const char* name) const {
  const Hdf5Lock lock;
  const Handle opened = attribute(object, name);
  const Handle type(opened ? H5Aget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Aget_space(opened.get()) : -1, H5Sclose);
  if (!type || !space || !is_fixed_text(type.get()) || !is_scalar(space.get()) ||
      H5Tget_size(type.get()) > believed_) {
    return std::nullopt;
  }
  std::string value(H5Tget_size(type.get()), '\0');
  // By the file's own type: HDF5 does not convert between character sets.
  if (H5Aread(opened.get(), type.get(), value.data()) < 0) {
    fail(fmt::format("attribute {}@{} cannot be read: {}", object, name,
                     hdf5::last_failure()));
  }
  return value;
}

bool Hdf5File::number_attribute(const std::string& object, const char* name,
                                StoredType wanted, void* to) const {
  const Hdf5Lock lock;
  const Handle opened = attribute(object, name);
  const Handle type(opened ? H5Aget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Aget_space(opened.get()) : -1, H5Sclose);
  if (!type || !space || H5Tequal(type.get(), hdf5::file_type(wanted)) <= 0 ||
      !is_scalar(space.get())) {
    return false;
  }
  if (H5Aread(opened.get(), hdf5::file_type(wanted), to) < 0) {
    fail(fmt::format("attribute {}@{} cannot be read: {}", object, name,
                     hdf5::last_failure()));
  }
  return true;
}

std::optional<std::string> Hdf5File::text(const std::string& path) const {
  const Hdf5Lock lock;
  const Handle opened(H5Dopen2(id_->get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(opened ? H5Dget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Dget_space(opened.get()) : -1, H5Sclose);
  if (!type || !space || !is_fixed_text(type.get()) || !is_scalar(space.get()) ||
      layout_of(opened.get()) != Layout::kContiguous ||
      H5Tget_size(type.get()) > believed_) {
    return std::nullopt;
  }
  std::string value(H5Tget_size(type.get()), '\0');
  if (H5Dread(opened.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()) <
      0) {
    fail(fmt::format("dataset {} cannot be read: {}", path, hdf5::last_failure()));
  }
  return value;
}

std::unique_ptr<const StoredDataset> Hdf5File::dataset(const std::string& path) const {
  const Hdf5Lock lock;
  // Without a cache of chunks, which would hold more than the rows that are asked for.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
  Handle opened(H5Dopen2(id_->get(), path.c_str(), access.get()), H5Dclose);
  const Handle type(opened ? H5Dget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Dget_space(opened.get()) : -1, H5Sclose);
  if (!type || !space) {
    fail(fmt::format("dataset {} cannot be opened: {}", path, hdf5::last_failure()));
  }
  StoredClaim claim = claim_of(type.get(), space.get());
  return std::make_unique<const Hdf5Dataset>(*this, path, std::move(opened),
                                             std::move(claim));
}

bool Hdf5File::same_object(const std::string& path, const std::string& other) const {
  const Hdf5Lock lock;
  H5O_info_t one{};
  H5O_info_t two{};
  return H5Oget_info_by_name2(id_->get(), path.c_str(), &one, H5O_INFO_BASIC,
                              H5P_DEFAULT) >= 0 &&
         H5Oget_info_by_name2(id_->get(), other.c_str(), &two, H5O_INFO_BASIC,
                              H5P_DEFAULT) >= 0 &&
         one.addr == two.addr;
}

bool Hdf5File::has_vtk_header(const std::string& group) const {
  const Hdf5Lock lock;
  std::array<std::int64_t, 2> version{};
  const Handle opened = attribute(group, "Version");
  const Handle space(opened ? H5Aget_space(opened.get()) : -1, H5Sclose);
  if (!space || H5Sget_simple_extent_npoints(space.get()) != hdf5::kVtkVersionSize ||
      H5Aread(opened.get(), H5T_NATIVE_INT64, version.data()) < 0 ||
      version != hdf5::kVtkVersion || !has_attribute(group, "Type")) {
    return false;
  }
  return text_attribute(group, "Type") == hdf5::kVtkType;
}

}  // namespace

bool has_hdf5() noexcept {
  return true;
}

std::unique_ptr<const StoredFile> open_hdf5(const std::filesystem::path& file) {
  std::error_code unknown;
  return std::make_unique<const Hdf5File>(utf8_of(file),
                                          std::filesystem::file_size(file, unknown),
                                          believed_bytes(file), [&] {
                                            return hdf5::open_read_only(file);
                                          });
}

std::unique_ptr<const StoredFile> open_hdf5(std::span<const std::byte> bytes,
                                            const std::string& name) {
  return std::make_unique<const Hdf5File>(name, bytes.size(), bytes.size(), [&] {
    return hdf5::open_in_memory(bytes);
  });
}

}  // namespace palpate
