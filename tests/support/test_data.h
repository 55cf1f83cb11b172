// Real meshes and measurements for tests; they are not part of the repository.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace palpate {

/// Path of a file in the folder of test data: $PALPATE_TEST_DATA, or ../shared/data
/// beside the source tree. Empty where it is absent; then the test is to be skipped:
///   const auto mesh = test_data("meshes/sofa_liver2.obj");
///   if (!mesh) GTEST_SKIP() << "no test data";
[[nodiscard]] std::optional<std::filesystem::path> test_data(const std::string& name);

/// All that a file holds; empty where there is none.
[[nodiscard]] std::string bytes_of(const std::filesystem::path& file);

/// A fresh empty folder for one test, taken away when the object dies.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate
