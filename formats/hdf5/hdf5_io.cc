#include "formats/hdf5/hdf5_io.h"

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "formats/base/input_file.h"
#include "formats/hdf5/hdf5_handle.h"

namespace palpate {

static_assert(std::endian::native == std::endian::little,
              "datasets pass between file and memory without conversion");

void ContentDigest::add(std::string_view head, const void* data, std::size_t bytes) {
  digest_.update(std::as_bytes(std::span(head.data(), head.size())));
  digest_.update({static_cast<const std::byte*>(data), bytes});
}

namespace {

std::recursive_mutex& hdf5_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

}  // namespace

Hdf5Lock::Hdf5Lock() : guard_(hdf5_mutex()) {}

void lock_hdf5() {
  hdf5_mutex().lock();
}

void unlock_hdf5() {
  hdf5_mutex().unlock();
}

QuietHdf5::QuietHdf5() {
  H5E_auto2_t function = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &function, &data_);
  function_ = reinterpret_cast<void*>(function);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietHdf5::~QuietHdf5() {
  H5Eset_auto2(H5E_DEFAULT, reinterpret_cast<H5E_auto2_t>(function_), data_);
}

void skip_hdf5_exit_cleanup() noexcept {
  H5dont_atexit();
}

namespace hdf5 {

hid_t open_read_only(const std::filesystem::path& file, unsigned flags) {
  require_regular_file(file);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  H5Pset_metadata_read_attempts(access.get(), 1);
  return H5Fopen(file.c_str(), H5F_ACC_RDONLY | flags, access.get());
}

Link link_at(hid_t file, const std::string& path) {
  std::size_t end = 0;
  do {
    end = path.find('/', end + 1);
    const std::string part = path.substr(0, end);
    H5L_info_t info{};
    if (part == "/") {
      continue;
    }
    if (H5Lexists(file, part.c_str(), H5P_DEFAULT) <= 0 ||
        H5Lget_info(file, part.c_str(), &info, H5P_DEFAULT) < 0) {
      return Link::kNone;
    }
    if (info.type != H5L_TYPE_HARD) {
      return Link::kOther;
    }
  } while (end != std::string::npos);
  return Link::kHard;
}

namespace {

// Chunks of a dataset that are in the file, against those that its extent needs.
bool has_every_chunk(hid_t dataset, hid_t space, hid_t create) {
  std::array<hsize_t, H5S_MAX_RANK> size{};
  std::array<hsize_t, H5S_MAX_RANK> chunk{};
  const int rank = H5Sget_simple_extent_dims(space, size.data(), nullptr);
  if (rank < 1 || H5Pget_chunk(create, rank, chunk.data()) != rank) {
    return false;
  }
  hsize_t stored = 0;
  if (H5Dget_num_chunks(dataset, space, &stored) < 0) {
    return false;
  }
  double needed = 1.0;  // as a double: a product of hostile extents overflows
  for (std::size_t i = 0; i < static_cast<std::size_t>(rank); ++i) {
    needed *= std::ceil(static_cast<double>(size[i]) / static_cast<double>(chunk[i]));
  }
  return static_cast<double>(stored) >= needed;
}

}  // namespace

bool holds_its_bytes(hid_t dataset) {
  const Handle create(H5Dget_create_plist(dataset), H5Pclose);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  if (!create || !space || H5Pget_external_count(create.get()) != 0) {
    return false;
  }
  const hssize_t values = H5Sget_simple_extent_npoints(space.get());
  switch (H5Pget_layout(create.get())) {
    case H5D_COMPACT:
      return true;
    case H5D_CONTIGUOUS:
      return values == 0 || H5Dget_storage_size(dataset) > 0;
    case H5D_CHUNKED:
      return values == 0 || has_every_chunk(dataset, space.get(), create.get());
    default:
      return false;
  }
}

hid_t file_type(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::kFloat64:
      return H5T_IEEE_F64LE;
    case Hdf5Type::kFloat32:
      return H5T_IEEE_F32LE;
    case Hdf5Type::kInt64:
      return H5T_STD_I64LE;
    case Hdf5Type::kInt32:
      return H5T_STD_I32LE;
    case Hdf5Type::kInt16:
      return H5T_STD_I16LE;
    case Hdf5Type::kUint8:
      break;
  }
  return H5T_STD_U8LE;
}

const char* name_of(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::kFloat64:
      return "float64";
    case Hdf5Type::kFloat32:
      return "float32";
    case Hdf5Type::kInt64:
      return "int64";
    case Hdf5Type::kInt32:
      return "int32";
    case Hdf5Type::kInt16:
      return "int16";
    case Hdf5Type::kUint8:
      break;
  }
  return "uint8";
}

std::size_t bytes_of(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::kFloat64:
    case Hdf5Type::kInt64:
      return 8;
    case Hdf5Type::kFloat32:
    case Hdf5Type::kInt32:
      return 4;
    case Hdf5Type::kInt16:
      return 2;
    case Hdf5Type::kUint8:
      break;
  }
  return 1;
}

Handle string_type(std::size_t bytes) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), bytes == 0 ? 1 : bytes);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

std::string last_failure() {
  std::string text;
  // Upwards, the first entry is the innermost: the cause.
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned n, const H5E_error2_t* entry, void* to) -> herr_t {
        if (n == 0 && entry->desc != nullptr) {
          *static_cast<std::string*>(to) = entry->desc;
        }
        return 0;
      },
      &text);
  return text.empty() ? "HDF5 gives no reason" : text;
}

std::string digest_head(const std::string& path, const char* type, std::int64_t rows,
                        std::int64_t columns) {
  return fmt::format("{} {} {} {}\n", path, type, rows, columns);
}

std::int64_t columns_of(const Hdf5Shape& shape) {
  return shape.size() < 2 ? 0
                          : std::accumulate(shape.begin() + 1, shape.end(),
                                            std::int64_t{1}, std::multiplies<>());
}

std::size_t values_in(const Hdf5Shape& shape) {
  return static_cast<std::size_t>(std::accumulate(
      shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>()));
}

}  // namespace hdf5
}  // namespace palpate
