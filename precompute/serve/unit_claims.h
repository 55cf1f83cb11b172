// Units handed out once among several services of one scene, by files in the folder
// that all of them see.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

namespace palpate {

/// A claim is a file that its owner touches again and again. A claim that nobody has
/// touched for `stale` is of a service that is gone, and anybody's. A claim of this
/// machine's services is anybody's as soon as their process has ended. Two services may
/// compute the same unit at once after all: their results have the same bytes. So a
/// claim saves work and nothing depends on it. Safe from several threads.
class UnitClaims {
 public:
  explicit UnitClaims(std::filesystem::path folder,
                      std::chrono::milliseconds stale = std::chrono::seconds(30));
  /// Gives back what is still claimed.
  ~UnitClaims();
  UnitClaims(const UnitClaims&) = delete;
  UnitClaims& operator=(const UnitClaims&) = delete;

  /// Whether the unit is this service's from now on; false: somebody else works on it,
  /// which is looked at once in a sixtieth of `stale`.
  [[nodiscard]] bool claim(std::int64_t unit);
  void give_back(std::int64_t unit);

 private:
  void touch_until_the_end(const std::stop_token& end) const;
  [[nodiscard]] std::filesystem::path file_of(std::int64_t unit) const;
  [[nodiscard]] std::filesystem::path unique(const std::string& what) const;
  [[nodiscard]] bool is_stale(const std::filesystem::path& file) const;

  std::filesystem::path folder_;
  std::chrono::milliseconds stale_;
  std::string me_;  // a line
  mutable std::mutex mutex_;
  mutable std::condition_variable_any ending_;
  std::map<std::int64_t, std::filesystem::path> mine_;
  std::map<std::int64_t, std::chrono::steady_clock::time_point> others_;  // seen last
  std::jthread touching_;
};

}  // namespace palpate
