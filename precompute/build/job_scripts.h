// A build shared out among machines: the shell scripts that any of them runs.
//
// A folder holds all of one job: `inputs.sha256` (checked before every shard: what a
// machine reads is what was submitted), `shard.sh I`, `merge.sh ROUND` and `start.sh`.
// A shard appears whole under its final name or not at all; two copies of one task do
// no harm. Exit 75 asks for another attempt; so does a merge that misses shards, twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

enum class JobEngine : std::uint8_t {
  kLocal,  ///< this machine
  kSlurm,  ///< job array, one task per shard; the merge after any end of it
};

/// @throws InputError unless it is "slurm" or "local".
[[nodiscard]] JobEngine job_engine(const std::string& name);

struct Job {
  JobEngine engine = JobEngine::kLocal;
  /// Its tasks are services of the scene (precompute/serve), which share its units and
  /// its output between them and with any other service; nothing is merged.
  bool serve = false;
  std::filesystem::path scene;   ///< absolute
  std::filesystem::path output;  ///< absolute
  std::filesystem::path folder;  ///< absolute
  std::filesystem::path tools;   ///< folder of palpate-precompute and palpate-db
  /// Files that the build reads, absolute, and their SHA-256.
  std::vector<std::pair<std::filesystem::path, std::string>> input;
  std::vector<std::string> build_flags;  ///< of every shard, or service
  std::vector<std::string> merge_flags;
  int shards = 2;        ///< >= 2; of services >= 1
  int at_once = 1;       ///< >= 1 shards under way at a time
  int workers = 0;       ///< threads of a shard; 0: all that the machine gives
  int minutes = 10;      ///< >= 1 time limit of a shard
  int memory_mb = 1000;  ///< >= 1 of a shard
};

/// Time limit [minutes] of one of `shards` equal parts of `seconds` of work. The limit
/// is three times the part's share, and ten minutes for what every shard does anew.
[[nodiscard]] int time_limit_minutes(double seconds, int shards);

/// One shell word that stands for `text`, whatever is in it.
[[nodiscard]] std::string shell_word(const std::string& text);

/// First 12 hexadecimal digits of the SHA-256 of inputs, flags and version: jobs of the
/// same name may take each other's shards.
[[nodiscard]] std::string job_digest(const Job& job);

[[nodiscard]] std::string shard_script(const Job& job);
[[nodiscard]] std::string merge_script(const Job& job);
[[nodiscard]] std::string start_script(const Job& job);

/// Writes the scripts and the list of inputs into job.folder, which it makes. Shards
/// that lie there stay. @throws InputError if it cannot be written.
void write_job(const Job& job);

}  // namespace palpate
