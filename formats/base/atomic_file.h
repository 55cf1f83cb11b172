// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace palpate {

/// Owns a temporary beside the target; commit() makes it durable and renames it over
/// the target. Destroyed without a commit, it takes the temporary away.
class AtomicFile {
 public:
  /// @throws InputError if the target's folder is missing or cannot be written.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// Makes these bytes the temporary's content. @throws InputError naming what failed,
  /// e.g. a full disk.
  void write(std::span<const std::byte> bytes) const;

  /// fsync, rename, fsync of the folder. @throws InputError naming what failed.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

}  // namespace palpate
