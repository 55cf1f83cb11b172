#include "formats/measurement/zip_archive.h"

#include <fmt/format.h>
#include <zip.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"

namespace palpate {

struct ZipArchive::Handle {
  zip_t* zip = nullptr;
  Handle() = default;
  ~Handle() {
    if (zip != nullptr) {
      zip_discard(zip);
    }
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
};

ZipArchive::ZipArchive(const std::filesystem::path& file)
    : file_(file.string()), handle_(std::make_unique<Handle>()) {
  require_regular_file(file);
  int code = 0;
  handle_->zip = zip_open(file.c_str(), ZIP_RDONLY, &code);
  if (handle_->zip == nullptr) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    throw FormatError(fmt::format(
        "{}: is a zip archive that cannot be opened ({}): it is cut short or "
        "damaged",
        file_, why));
  }
}

ZipArchive::~ZipArchive() = default;

std::vector<std::string> ZipArchive::names() const {
  std::vector<std::string> names;
  const zip_int64_t count = zip_get_num_entries(handle_->zip, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name =
        zip_get_name(handle_->zip, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_GUESS);
    names.emplace_back(name != nullptr ? name : "");
  }
  return names;
}

bool ZipArchive::has(const std::string& name) const {
  return zip_name_locate(handle_->zip, name.c_str(), 0) >= 0;
}

std::string ZipArchive::read(const std::string& name) const {
  const auto fail = [&](const std::string& why) {
    throw FormatError(fmt::format("{}: entry \"{}\" {}", file_, name, why));
  };
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat(handle_->zip, name.c_str(), 0, &stat) != 0 ||
      (stat.valid & ZIP_STAT_SIZE) == 0) {
    fail("is not in the archive");
  }
  if (stat.size > kZipEntryMax) {
    fail(
        fmt::format("would be {} bytes, at most {} are read", stat.size, kZipEntryMax));
  }
  zip_file_t* entry = zip_fopen(handle_->zip, name.c_str(), 0);
  if (entry == nullptr) {
    fail(fmt::format("cannot be opened: {}", zip_strerror(handle_->zip)));
  }
  // Grown as bytes come: the stated size is the file's word.
  std::string bytes;
  constexpr std::size_t kPiece = 1 << 16;
  zip_int64_t count = 0;
  do {
    const std::size_t size = bytes.size();
    bytes.resize(size + kPiece);
    count = zip_fread(entry, bytes.data() + size, kPiece);
    bytes.resize(size + static_cast<std::size_t>(count > 0 ? count : 0));
  } while (count > 0 && bytes.size() <= kZipEntryMax);
  const std::string why = count < 0 ? zip_file_strerror(entry) : "";
  zip_fclose(entry);
  if (count < 0) {
    fail(fmt::format("cannot be read: {}", why));
  }
  if (bytes.size() != stat.size) {
    fail(fmt::format("holds {} bytes of {}", bytes.size(), stat.size));
  }
  return bytes;
}

const ZipArchive& open_archive(const std::filesystem::path& file) {
  struct Kept {
    std::filesystem::path file;
    std::filesystem::file_time_type written;
    std::uintmax_t bytes = 0;
    std::unique_ptr<ZipArchive> zip;
  };
  thread_local Kept kept;
  require_regular_file(file);
  const auto written = std::filesystem::last_write_time(file);
  const std::uintmax_t bytes = std::filesystem::file_size(file);
  if (!kept.zip || kept.file != file || kept.written != written ||
      kept.bytes != bytes) {
    kept.zip.reset();  // where the next cannot be opened
    kept = Kept{file, written, bytes, std::make_unique<ZipArchive>(file)};
  }
  return *kept.zip;
}

bool is_zip(std::string_view head) {
  return head.starts_with("PK\x03\x04");
}

}  // namespace palpate
