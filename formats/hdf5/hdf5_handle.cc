#include "formats/hdf5/hdf5_handle.h"

#include <array>
#include <cmath>

#include "formats/base/input_file.h"
#include "formats/base/utf8_path.h"

namespace palpate::hdf5 {

namespace {

Handle reading_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  H5Pset_metadata_read_attempts(access.get(), 1);
  return access;
}

}  // namespace

hid_t open_read_only(const std::filesystem::path& file, unsigned flags) {
  require_regular_file(file);
  const Handle access = reading_access();
  return H5Fopen(utf8_of(file).c_str(), H5F_ACC_RDONLY | flags, access.get());
}

hid_t open_in_memory(std::span<const std::byte> bytes) {
  constexpr std::size_t kGrowth = std::size_t{1} << 20;
  const Handle access = reading_access();
  // HDF5 takes a copy, and changes none of the bytes.
  if (H5Pset_fapl_core(access.get(), kGrowth, false) < 0 ||
      H5Pset_file_image(access.get(), const_cast<std::byte*>(bytes.data()),
                        bytes.size()) < 0) {
    return -1;
  }
  // HDF5 tells open files apart by name; this one names no file.
  static int count = 0;
  const std::string name = "bytes in memory " + std::to_string(++count);
  return H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get());
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

hid_t file_type(StoredType type) {
  switch (type) {
    case StoredType::kFloat64:
      return H5T_IEEE_F64LE;
    case StoredType::kFloat32:
      return H5T_IEEE_F32LE;
    case StoredType::kInt64:
      return H5T_STD_I64LE;
    case StoredType::kInt32:
      return H5T_STD_I32LE;
    case StoredType::kInt16:
      return H5T_STD_I16LE;
    case StoredType::kUint8:
      break;
  }
  return H5T_STD_U8LE;
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

}  // namespace palpate::hdf5
