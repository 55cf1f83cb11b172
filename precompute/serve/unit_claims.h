// Units handed out once among several services of one scene, by files in the folder
// that all of them see.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace palpate {

/// A claim is a file that its owner touches again and again; one that nobody has
/// touched for `stale` is of a service that is gone, and anybody's. What two compute at
/// once after all has the same bytes, so that a claim saves work and nothing depends on
/// it. Safe from several threads.
class UnitClaims {
 public:
  explicit UnitClaims(std::filesystem::path folder,
                      std::chrono::milliseconds stale = std::chrono::seconds(30));
  /// Gives back what is still claimed.
  ~UnitClaims();
  UnitClaims(const UnitClaims&) = delete;
  UnitClaims& operator=(const UnitClaims&) = delete;

  /// Whether the unit is this service's from now on; false: somebody else works on it.
  [[nodiscard]] bool claim(std::int64_t unit);
  void give_back(std::int64_t unit);

  /// To be called more often than `stale` passes.
  void touch_all() const;

 private:
  [[nodiscard]] std::filesystem::path file_of(std::int64_t unit) const;
  [[nodiscard]] std::filesystem::path unique(const std::string& what) const;
  [[nodiscard]] bool is_stale(const std::filesystem::path& file) const;

  std::filesystem::path folder_;
  std::chrono::milliseconds stale_;
  std::string me_;  // a line
  mutable std::mutex mutex_;
  std::map<std::int64_t, std::filesystem::path> mine_;
};

}  // namespace palpate
