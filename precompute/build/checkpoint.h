// Units that are done, one file each, in a folder beside the output.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "formats/database/work_unit.h"

namespace palpate {

class Checkpoint {
 public:
  /// Opens "OUTPUT.partial". @throws InputError if it holds units and `resume` is
  /// false, or units of another plan.
  Checkpoint(const std::filesystem::path& output, const JobDescription& plan,
             bool resume);
  /// Takes the folder away if it holds no unit.
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// A unit that was kept; none if it is missing or damaged, or if one of its nodes
  /// breaks a rule (is_sound): such a unit is computed again.
  [[nodiscard]] std::optional<WorkUnitOutcome> load(std::int64_t unit) const;

  /// Keeps a unit: whole or not at all, whenever the power goes. Safe from several
  /// threads for different units.
  void keep(const WorkUnitOutcome& unit) const;

  /// Whether the folder is there: whoever has put the file together takes it away.
  [[nodiscard]] bool is_there() const;

  /// Makes the folder, without units, where it is not there. @throws InputError if it
  /// cannot be made.
  void make() const;

  /// Takes the folder away. From the first moment on it is not there for others.
  void remove() const;

 private:
  [[nodiscard]] std::filesystem::path file_of(std::int64_t unit) const;
  [[nodiscard]] std::filesystem::path digest_file() const;
  [[nodiscard]] bool holds_units() const;

  std::filesystem::path folder_;
  std::string digest_;  // of the plan
};

}  // namespace palpate
