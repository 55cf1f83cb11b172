#include "tests/support/test_data.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "formats/base/durable_file.h"

namespace palpate {

std::optional<std::filesystem::path> test_data(const std::string& name) {
  const char* set = std::getenv("PALPATE_TEST_DATA");
  const std::filesystem::path root =
      set != nullptr ? set
                     : std::filesystem::path(PALPATE_SOURCE_DIR) / "../shared/data";
  std::error_code ignored;
  if (!std::filesystem::exists(root / name, ignored)) {
    return std::nullopt;
  }
  return root / name;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

ScratchFolder::ScratchFolder() {
  int attempt = 0;
  do {
    path_ = std::filesystem::temp_directory_path() /
            fmt::format("palpate-test-{}-{}", process_id(), attempt++);
  } while (!std::filesystem::create_directory(path_));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace palpate
