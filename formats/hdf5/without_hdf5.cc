// What a build without HDF5 has in place of this sub-room's other sources.
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/utf8_path.h"
#include "formats/hdf5/hdf5_file.h"
#include "formats/hdf5/hdf5_lock.h"

namespace palpate {
namespace {

[[noreturn]] void is_hdf5(const std::string& name) {
  throw FormatError(
      fmt::format("{}: is an HDF5 file, this build reads flat ones: convert it by "
                  "palpate-db export FILE --flat FILE.palpate of a build with HDF5",
                  name));
}

}  // namespace

bool has_hdf5() noexcept {
  return false;
}

std::unique_ptr<const StoredFile> open_hdf5(const std::filesystem::path& file) {
  is_hdf5(utf8_of(file));
}

std::unique_ptr<const StoredFile> open_hdf5(std::span<const std::byte> /*bytes*/,
                                            const std::string& name) {
  is_hdf5(name);
}

std::unique_ptr<StoredSink> make_hdf5_sink(bool /*compress*/) {
  throw InputError("this build has no HDF5: it writes flat files");
}

void lock_hdf5() {}

void unlock_hdf5() {}

void skip_hdf5_exit_cleanup() noexcept {}

}  // namespace palpate
