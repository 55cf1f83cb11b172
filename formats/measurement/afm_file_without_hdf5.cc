// What a build without HDF5 has in place of afm_file.cc.
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/afm_file.h"

namespace palpate {
namespace {

[[noreturn]] void cannot_read_afm(const std::filesystem::path& file) {
  throw InputError(fmt::format(
      "{}: cannot be read: force curves of afmformats are HDF5 files, which this build "
      "does not read",
      file.string()));
}

}  // namespace

std::vector<int> afm_curves(const std::filesystem::path& file) {
  cannot_read_afm(file);
}

MeasurementFile read_afm_curve(const std::filesystem::path& file, int /*number*/) {
  cannot_read_afm(file);
}

}  // namespace palpate
