#include "formats/base/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "formats/base/durable_file.h"
#include "formats/base/error.h"
#include "formats/base/utf8_path.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

void cannot_be(const fs::path& file, const char* what, int error) {
  const std::string text =
      fmt::format("{}: cannot be {}: {}", utf8_of(file), what, std::strerror(error));
  if (is_passing(error)) {
    throw ResourceError(text);
  }
  throw InputError(text);
}

AtomicFile::AtomicFile(const fs::path& target) : target_(target) {
  std::error_code ignored;
  if (fs::is_symlink(target_, ignored)) {  // write what the link points at, keep it
    target_ = fs::weakly_canonical(target_, ignored);
  }
  const fs::file_status status = fs::status(target_, ignored);
  if (!target_.has_filename() || (fs::exists(status) && !fs::is_regular_file(status))) {
    throw InputError(
        fmt::format("{}: cannot be written: is not a regular file", utf8_of(target)));
  }
  int error = EEXIST;
  for (int attempt = 0; attempt < 1000 && error == EEXIST; ++attempt) {
    temporary_ = folder_of(target_) /
                 path_of_utf8(fmt::format(".{}.{}-{}.tmp", utf8_of(target_.filename()),
                                          process_id(), attempt));
    error = create_file(temporary_);
  }
  if (error != 0) {
    cannot_be(target, "written", error);
  }
}

AtomicFile::~AtomicFile() {
  if (!committed_) {
    std::error_code ignored;
    fs::remove(temporary_, ignored);
  }
}

void AtomicFile::write(std::span<const std::byte> bytes) const {
  if (const int error = overwrite_file(temporary_, bytes); error != 0) {
    cannot_be(target_, "written", error);
  }
}

void AtomicFile::commit() {
  if (const int error = flush_file(temporary_); error != 0) {
    cannot_be(target_, "made durable", error);
  }
  std::error_code moved;
  fs::rename(temporary_, target_, moved);
  if (moved) {
    cannot_be(target_, "written", moved.default_error_condition().value());
  }
  committed_ = true;
  if (const int error = flush_folder(folder_of(target_)); error != 0) {
    cannot_be(target_, "made durable", error);
  }
}

}  // namespace palpate
