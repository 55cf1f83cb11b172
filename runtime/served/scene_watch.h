// Whether a scene's file has been changed and saved since it is served.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace palpate {

/// Looks at the file once a second at most. One thread.
class SceneWatch {
 public:
  static constexpr std::chrono::milliseconds kEvery{1000};

  explicit SceneWatch(std::filesystem::path scene) : scene_(std::move(scene)) {}

  /// @param served text of the scene that is served. A file that is gone, or empty as
  /// an editor may leave it for a moment, has not changed.
  [[nodiscard]] bool changed_from(const std::string& served);

 private:
  std::filesystem::path scene_;
  std::chrono::steady_clock::time_point looked_;
  bool changed_ = false;
};

}  // namespace palpate
