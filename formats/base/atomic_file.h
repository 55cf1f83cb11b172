// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace palpate {

/// @param what "written", @param error errno. @throws ResourceError for a full disk and
/// what else may pass, InputError for anything else; saying what, and why not.
[[noreturn]] void cannot_be(const std::filesystem::path& file, const char* what,
                            int error);

/// Owns a temporary beside the target; commit() makes it durable and renames it over
/// the target. Destroyed without a commit, it takes the temporary away. Throws as
/// cannot_be().
class AtomicFile {
 public:
  /// @throws InputError if the target's folder is missing, or not to be written.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// Makes these bytes the temporary's content.
  void write(std::span<const std::byte> bytes) const;

  /// fsync, rename, fsync of the folder.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

}  // namespace palpate
