#include "formats/forms/open_stored.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/utf8_path.h"
#include "formats/flat/flat_directory.h"
#include "formats/flat/flat_file.h"
#include "formats/hdf5/hdf5_file.h"

namespace palpate {
namespace {

constexpr std::size_t kMagicBytes = kHdf5Magic.size();
static_assert(kFlatMagic.size() == kMagicBytes);

struct FileBegin {
  std::string magic;
  std::uintmax_t bytes = 0;
};

FileBegin begin_of(const std::filesystem::path& file) {
  require_regular_file(file);
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::array<char, kMagicBytes> magic{};
  in.read(magic.data(), magic.size());
  if (in.bad() || (!in && !in.eof())) {
    throw InputError(fmt::format("{}: cannot be opened: {}", utf8_of(file),
                                 std::strerror(errno == 0 ? EIO : errno)));
  }
  std::error_code unknown;
  const std::uintmax_t bytes = std::filesystem::file_size(file, unknown);
  if (unknown) {
    throw InputError(
        fmt::format("{}: cannot be opened: {}", utf8_of(file), unknown.message()));
  }
  return {{magic.data(), static_cast<std::size_t>(in.gcount())}, bytes};
}

FileBegin begin_of(std::span<const std::byte> bytes) {
  const std::span<const std::byte> head =
      bytes.first(std::min(bytes.size(), kMagicBytes));
  return {{reinterpret_cast<const char*>(head.data()), head.size()}, bytes.size()};
}

}  // namespace

std::unique_ptr<const StoredFile> open_stored(const StoredSource& source) {
  const std::string name = source.name();
  const FileBegin begin =
      source.in_memory() ? begin_of(source.bytes()) : begin_of(source.path());
  if (begin.magic == kFlatMagic) {
    return source.in_memory() ? open_flat(source.bytes(), name)
                              : open_flat(source.path());
  }
  if (begin.magic == kHdf5Magic) {
    return source.in_memory() ? open_hdf5(source.bytes(), name)
                              : open_hdf5(source.path());
  }
  throw FormatError(
      fmt::format("{}: is not an HDF5 file ({} bytes), nor a flat one, must be a "
                  "response database",
                  name, begin.bytes));
}

StoredForm form_of(const std::filesystem::path& file) {
  return file.extension() == ".palpate" || !has_hdf5() ? StoredForm::kFlat
                                                       : StoredForm::kHdf5;
}

StoredWriter make_writer(StoredForm form, const StorageOptions& storage) {
  return StoredWriter(
      form == StoredForm::kFlat ? make_flat_sink() : make_hdf5_sink(storage.compress),
      storage.precision);
}

std::string database_sha256(const StoredSource& source) {
  return StoredReader(open_stored(source)).remark("/", kDigestName);
}

}  // namespace palpate
