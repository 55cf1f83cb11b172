// Units that are done, one file each, in a folder beside the output.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "formats/database/work_unit.h"
#include "precompute/build/folder_lock.h"

namespace palpate {

class Checkpoint {
 public:
  /// Opens "OUTPUT.partial", and locks it as long as this lives. @throws InputError if
  /// it holds units and `resume` is false, or units of another plan; ResourceError as
  /// FolderLock.
  Checkpoint(const std::filesystem::path& output, const JobDescription& plan,
             bool resume, FolderUse use = FolderUse::kAlone);
  /// Takes the folder away if it holds no unit.
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// A unit that was kept; none if it is missing or damaged, or if one of its nodes
  /// breaks a rule (is_sound). Such a unit is computed again.
  [[nodiscard]] std::optional<WorkUnitOutcome> load(std::int64_t unit) const;

  /// Keeps a unit: whole or not at all, whenever the power goes. Safe from several
  /// threads for different units. @throws as AtomicFile.
  void keep(const WorkUnitOutcome& unit) const;

  [[nodiscard]] bool holds_units() const;

  /// Whether the folder is there: whoever has put the file together takes it away.
  [[nodiscard]] bool is_there() const;

  /// Makes the folder, without units, where it is not there. @throws as AtomicFile.
  void make() const;

  /// Takes the folder away. From the first moment on it is not there for others.
  void remove() const;

 private:
  [[nodiscard]] std::filesystem::path file_of(std::int64_t unit) const;
  [[nodiscard]] std::filesystem::path digest_file() const;
  void make_folder() const;
  void remove_units() const;

  std::filesystem::path folder_;
  std::string digest_;  // of the plan
  std::optional<FolderLock> lock_;
};

}  // namespace palpate
