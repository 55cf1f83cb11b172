#include "formats/hdf5/hdf5_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>

#include <fmt/ranges.h>
#include <sys/stat.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/hdf5/hdf5_handle.h"

namespace palpate {
namespace {

using hdf5::Handle;

std::string dimensions_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank <= 0 || rank > H5S_MAX_RANK) {
    return rank == 0 ? "a scalar" : "no array";
  }
  std::array<hsize_t, H5S_MAX_RANK> size{};
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  std::string text;
  for (int i = 0; i < rank; ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : " x ", size[static_cast<std::size_t>(i)]);
  }
  return "(" + text + ")";
}

std::optional<Hdf5Shape> extent_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  std::array<hsize_t, H5S_MAX_RANK> size{};
  if (rank <= 0 || rank > H5S_MAX_RANK ||
      H5Sget_simple_extent_dims(space, size.data(), nullptr) < 0) {
    return std::nullopt;
  }
  return Hdf5Shape(size.begin(), size.begin() + rank);
}

bool matches(const Hdf5Shape& shape, const Hdf5Shape& wanted) {
  return std::equal(shape.begin(), shape.end(), wanted.begin(), wanted.end(),
                    [](std::int64_t is, std::int64_t must) {
                      return is >= 0 && (must < 0 || is == must);
                    });
}

std::string shape_text(const Hdf5Shape& wanted) {
  std::string text;
  for (const std::int64_t size : wanted) {
    text += text.empty() ? "rows" : size < 0 ? " x any" : fmt::format(" x {}", size);
  }
  return "(" + text + ")";
}

bool is_scalar(hid_t space) {
  return H5Sget_simple_extent_type(space) == H5S_SCALAR;
}

// A fixed-length string; variable-length ones point into the file and are not read.
bool is_fixed_text(hid_t type) {
  return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
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

// Deflate makes at most 1032 bytes of one.
constexpr std::uint64_t kInflation = 1032;

// Of a file with holes nothing larger is believed. [bytes]
constexpr std::uintmax_t kSmall = std::uintmax_t{1} << 30;

// What a file takes on its disk. A file system that compresses writes less than the
// file's size, but not less than deflate would. [bytes]
std::uintmax_t written_bytes(const std::filesystem::path& file) {
  struct stat status {};
  constexpr std::uintmax_t kBlock = 512;
  return ::stat(file.c_str(), &status) == 0
             ? kBlock * static_cast<std::uintmax_t>(status.st_blocks)
             : 0;
}

}  // namespace

Hdf5Reader::Hdf5Reader(const std::filesystem::path& file) : file_(file) {
  require_regular_file(file);
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::array<char, 8> head{};
  in.read(head.data(), head.size());
  if (in.bad() || (!in && !in.eof())) {
    throw InputError(fmt::format("{}: cannot be opened: {}", file.string(),
                                 std::strerror(errno == 0 ? EIO : errno)));
  }
  std::error_code unknown;
  bytes_ = std::filesystem::file_size(file, unknown);
  if (unknown) {
    throw InputError(
        fmt::format("{}: cannot be opened: {}", file.string(), unknown.message()));
  }
  if (std::memcmp(head.data(), "\x89HDF\r\n\x1a\n", head.size()) != 0) {
    fail(fmt::format("is not an HDF5 file ({} bytes), must be a response database",
                     bytes_));
  }
  // A file with holes states any size at no cost. Its size is then no measure of how
  // much memory its datasets may ask for.
  if (const std::uintmax_t written = written_bytes(file);
      bytes_ / kInflation > written) {
    bytes_ = std::min(bytes_, std::max(kSmall, written));
  }
  id_ = hdf5::open_read_only(file);
  if (id_ < 0) {
    fail(fmt::format("is truncated or damaged ({} bytes): {}", bytes_,
                     hdf5::last_failure()));
  }
}

Hdf5Reader::~Hdf5Reader() {
  kept_.clear();
  if (id_ >= 0) {
    H5Fclose(id_);
  }
}

void Hdf5Reader::fail_of_memory(const std::string& path, const Hdf5Shape& shape) const {
  fail(fmt::format("dataset {} of {} values is more than the memory holds", path,
                   fmt::join(shape, " x ")));
}

void Hdf5Reader::fail(const std::string& what) const {
  throw FormatError(fmt::format("{}: {}", file_.string(), what));
}

bool Hdf5Reader::has(const std::string& path) const {
  if (const auto known = kept_.find(path); known != kept_.end() && known->second) {
    return true;
  }
  const hdf5::Link link = hdf5::link_at(id_, path);
  if (link == hdf5::Link::kOther) {
    fail(fmt::format("{} is behind a soft or external link, must be in the file itself",
                     path));
  }
  return link == hdf5::Link::kHard;
}

bool Hdf5Reader::has_attribute(const std::string& object, const char* name) const {
  return has(object) && H5Aexists_by_name(id_, object.c_str(), name, H5P_DEFAULT) > 0;
}

void Hdf5Reader::group(const std::string& path) const {
  if (!has(path)) {
    fail(fmt::format("group {} is missing", path));
  }
  const Handle opened(H5Gopen2(id_, path.c_str(), H5P_DEFAULT), H5Gclose);
  if (!opened) {
    fail(fmt::format("{} cannot be opened as a group: {}", path, hdf5::last_failure()));
  }
}

std::string Hdf5Reader::read_text_attribute(const std::string& object,
                                            const char* name) const {
  if (!has_attribute(object, name)) {
    fail(fmt::format("attribute {}@{} is missing", object, name));
  }
  const Handle opened(
      H5Aopen_by_name(id_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const Handle type(opened ? H5Aget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Aget_space(opened.get()) : -1, H5Sclose);
  if (!type || !space || !is_fixed_text(type.get()) || !is_scalar(space.get()) ||
      H5Tget_size(type.get()) > bytes_) {
    fail(fmt::format("attribute {}@{} is not a fixed-length text", object, name));
  }
  std::string value(H5Tget_size(type.get()), '\0');
  // By the file's own type: HDF5 does not convert between character sets.
  if (H5Aread(opened.get(), type.get(), value.data()) < 0) {
    fail(fmt::format("attribute {}@{} cannot be read: {}", object, name,
                     hdf5::last_failure()));
  }
  value.erase(value.find_last_not_of('\0') + 1);
  return value;
}

void Hdf5Reader::attribute(const std::string& object, const char* name,
                           std::string& value) {
  value = read_text_attribute(object, name);
  digest_.add(hdf5::digest_head(object + "@" + name, "text",
                                static_cast<std::int64_t>(value.size()), 0),
              value.data(), value.size());
}

template <typename T>
void Hdf5Reader::read_number(const std::string& object, const char* name,
                             T& value) const {
  if (!has_attribute(object, name)) {
    fail(fmt::format("attribute {}@{} is missing", object, name));
  }
  const Hdf5Type wanted = hdf5_type<T>();
  const Handle opened(
      H5Aopen_by_name(id_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const Handle type(opened ? H5Aget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Aget_space(opened.get()) : -1, H5Sclose);
  if (!type || !space || H5Tequal(type.get(), hdf5::file_type(wanted)) <= 0 ||
      !is_scalar(space.get())) {
    fail(fmt::format("attribute {}@{} has the wrong type, must be one {}", object, name,
                     hdf5::name_of(wanted)));
  }
  if (H5Aread(opened.get(), hdf5::file_type(wanted), &value) < 0) {
    fail(fmt::format("attribute {}@{} cannot be read: {}", object, name,
                     hdf5::last_failure()));
  }
}

void Hdf5Reader::attribute(const std::string& object, const char* name, double& value) {
  read_number(object, name, value);
  digest_.add(hdf5::digest_head(object + "@" + name, "float64", 1, 0), &value,
              sizeof value);
}

void Hdf5Reader::attribute(const std::string& object, const char* name,
                           std::int64_t& value) {
  value = remark_number(object, name);
  digest_.add(hdf5::digest_head(object + "@" + name, "int64", 1, 0), &value,
              sizeof value);
}

std::int64_t Hdf5Reader::remark_number(const std::string& object,
                                       const char* name) const {
  std::int64_t value = 0;
  read_number(object, name, value);
  return value;
}

void Hdf5Reader::text(const std::string& path, std::string& value) {
  if (!has(path)) {
    fail(fmt::format("dataset {} is missing", path));
  }
  const Handle opened(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(opened ? H5Dget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Dget_space(opened.get()) : -1, H5Sclose);
  if (!type || !space || !is_fixed_text(type.get()) || !is_scalar(space.get()) ||
      layout_of(opened.get()) != Layout::kContiguous ||
      H5Tget_size(type.get()) > bytes_) {
    fail(fmt::format("dataset {} is not one fixed-length text", path));
  }
  value.assign(H5Tget_size(type.get()), '\0');
  if (H5Dread(opened.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()) <
      0) {
    fail(fmt::format("dataset {} cannot be read: {}", path, hdf5::last_failure()));
  }
  value.erase(value.find_last_not_of('\0') + 1);
  digest_.add(
      hdf5::digest_head(path, "text", static_cast<std::int64_t>(value.size()), 0),
      value.data(), value.size());
}

Hdf5Shape Hdf5Reader::checked_shape(const std::string& path, const char* units,
                                    Hdf5Type type, const Hdf5Shape& wanted) const {
  if (!has(path)) {
    fail(fmt::format("dataset {} is missing", path));
  }
  const Handle opened(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle stored(opened ? H5Dget_type(opened.get()) : -1, H5Tclose);
  const Handle space(opened ? H5Dget_space(opened.get()) : -1, H5Sclose);
  if (!stored || !space) {
    fail(fmt::format("dataset {} cannot be opened: {}", path, hdf5::last_failure()));
  }
  if (H5Tequal(stored.get(), hdf5::file_type(type)) <= 0) {
    fail(fmt::format("dataset {} has the wrong element type, must be {}", path,
                     hdf5::name_of(type)));
  }
  const std::optional<Hdf5Shape> shape = extent_of(space.get());
  if (!shape || !matches(*shape, wanted)) {
    fail(fmt::format("dataset {} has the shape {}, must be {}", path,
                     dimensions_of(space.get()), shape_text(wanted)));
  }
  const Layout layout = layout_of(opened.get());
  if (layout == Layout::kForeign) {
    fail(
        fmt::format("dataset {} is external or filtered, must be contiguous, or "
                    "shuffled and deflated",
                    path));
  }
  // What is small is not worth a look: rows that were never written are zeros.
  constexpr std::uint64_t kFree = 1 << 20;
  const std::uint64_t inflation = layout == Layout::kCompressed ? kInflation : 1;
  const auto require_room = [&](std::uint64_t bytes) {
    std::uint64_t most = bytes * inflation / hdf5::bytes_of(type);
    for (const std::int64_t size : *shape) {
      if (size > 0 && static_cast<std::uint64_t>(size) > most) {
        fail(fmt::format(
            "dataset {} claims {} rows, more than a file of {} bytes can hold", path,
            shape->front(), bytes));
      }
      most /= std::max<std::uint64_t>(1, static_cast<std::uint64_t>(size));
    }
  };
  require_room(bytes_);
  if (hdf5::values_in(*shape) * hdf5::bytes_of(type) > kFree) {
    if (!hdf5::holds_its_bytes(opened.get())) {
      fail(fmt::format("dataset {} claims {} rows that were never written", path,
                       shape->front()));
    }
    require_room(std::min<std::uint64_t>(bytes_, H5Dget_storage_size(opened.get())));
  }
  const std::string found = read_text_attribute(path, "units");
  if (found != units) {
    fail(fmt::format("dataset {} has the units \"{}\", must be \"{}\"", path, found,
                     units));
  }
  return *shape;
}

void Hdf5Reader::read(const std::string& path, Hdf5Type type, void* to,
                      const Hdf5Shape& shape, bool digested) {
  const Handle opened(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
  const std::size_t values = hdf5::values_in(shape);
  if (!opened || (values > 0 && H5Dread(opened.get(), hdf5::file_type(type), H5S_ALL,
                                        H5S_ALL, H5P_DEFAULT, to) < 0)) {
    fail(fmt::format("dataset {} cannot be read: {}", path, hdf5::last_failure()));
  }
  if (digested) {
    digest_.add(hdf5::digest_head(path, hdf5::name_of(type), shape.front(),
                                  hdf5::columns_of(shape)),
                to, values * hdf5::bytes_of(type));
  }
}

void Hdf5Reader::link(const std::string& path, const std::string& object) const {
  H5O_info_t one{};
  H5O_info_t other{};
  if (!has(path) ||
      H5Oget_info_by_name2(id_, path.c_str(), &one, H5O_INFO_BASIC, H5P_DEFAULT) < 0 ||
      H5Oget_info_by_name2(id_, object.c_str(), &other, H5O_INFO_BASIC, H5P_DEFAULT) <
          0 ||
      one.addr != other.addr) {
    fail(fmt::format("{} is not a link to {}", path, object));
  }
}

void Hdf5Reader::vtk_header(const std::string& group) const {
  std::array<std::int64_t, 2> version{};
  const Handle opened(
      H5Aopen_by_name(id_, group.c_str(), "Version", H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  const Handle space(opened ? H5Aget_space(opened.get()) : -1, H5Sclose);
  if (!space || H5Sget_simple_extent_npoints(space.get()) != 2 ||
      H5Aread(opened.get(), H5T_NATIVE_INT64, version.data()) < 0 ||
      version != hdf5::kVtkVersion ||
      read_text_attribute(group, "Type") != hdf5::kVtkType) {
    fail(fmt::format("{} has not the type {} and the version 1.0 of VTK", group,
                     hdf5::kVtkType));
  }
}

}  // namespace palpate
