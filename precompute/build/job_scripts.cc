#include "precompute/build/job_scripts.h"

#include <cmath>
#include <span>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/sha256.h"
#include "precompute/build/program_digest.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// Attempts of a merge that misses shards, after the first.
constexpr int kMergeRetries = 2;

std::string words(const std::vector<std::string>& flags) {
  std::string text;
  for (const std::string& flag : flags) {
    text += " " + shell_word(flag);
  }
  return text;
}

void write_text(const fs::path& file, const std::string& text) {
  AtomicFile target(file);
  target.write(std::as_bytes(std::span(text)));
  target.commit();
}

// What every script begins with.
std::string head(const Job& job, const std::string& what) {
  return fmt::format("#!/bin/bash\n# {}\nset -u\ncd {} || exit 75\nshards={}\n", what,
                     shell_word(job.folder.string()), job.shards);
}

// start.sh LIST ROUND: the listed shards, then the merge.
std::string slurm_start(const Job& job) {
  const std::string cores = job.workers > 0
                                ? fmt::format(" --cpus-per-task={}", job.workers)
                                : " --exclusive";
  return fmt::format(
      "array=$(sbatch --parsable --job-name=palpate --requeue --open-mode=append \\\n"
      "  --time={} --mem={}M{} \\\n"
      "  --output=shard-%a.log --array=\"$list%{}\" shard.sh) || exit 1\n"
      "array=${{array%%;*}}\n"
      "merge=$(sbatch --parsable --job-name=palpate-merge --open-mode=append \\\n"
      "  --time={} --mem={}M --output=merge.log \\\n"
      "  --dependency=\"afterany:$array\" merge.sh \"$round\") || exit 1\n"
      "echo \"array $array, merge ${{merge%%;*}}\"\n",
      job.minutes, job.memory_mb, cores, job.at_once, job.minutes, job.memory_mb);
}

// What a shard runs; a shard that is done leaves a file of its name.
std::string work_line(const Job& job) {
  const std::string workers = job.workers > 0 ? fmt::format("{}", job.workers)
                                              : std::string("${SLURM_CPUS_ON_NODE:-0}");
  const std::string program = shell_word((job.tools / "palpate-precompute").string());
  const std::string scene = shell_word(job.scene.string());
  if (job.serve) {  // a socket cannot be shared among machines: everybody has their own
    return fmt::format(
        "place=$(mktemp -d) || exit 75\n"
        "trap 'rm -rf \"$place\"' EXIT\n"
        "{} serve {} -o {} \\\n"
        "  --socket \"$place/palpate.socket\" --threads \"{}\"{} \\\n"
        "  && touch \"shard-$shard\"\n",
        program, scene, shell_word(job.output.string()), workers,
        words(job.build_flags));
  }
  return fmt::format(
      "{} build {} -o \"shard-$shard\" \\\n"
      "  --shard \"$shard/$shards\" --resume --threads \"{}\"{}\n",
      program, scene, workers, words(job.build_flags));
}

// What follows when all shards are there. Services have put the output together.
std::string merge_line(const Job& job) {
  const std::string output = shell_word(job.output.string());
  if (job.serve) {
    return "[ -e \"$output\" ] || exit 75\n";
  }
  return fmt::format("exec {} merge \"${{files[@]}}\" -o {}{}\n",
                     shell_word((job.tools / "palpate-db").string()), output,
                     words(job.merge_flags));
}

std::string local_start(const Job& job) {
  return fmt::format(
      "for shard in ${{list//,/ }}; do\n"
      "  while (($(jobs -rp | wc -l) >= {})); do wait -n; done\n"
      "  bash shard.sh \"$shard\" >> \"shard-$shard.log\" 2>&1 &\n"
      "done\n"
      "wait\n"
      "exec bash merge.sh \"$round\"\n",
      job.at_once);
}

}  // namespace

JobEngine job_engine(const std::string& name) {
  if (name == "local") {
    return JobEngine::kLocal;
  }
  if (name == "slurm") {
    return JobEngine::kSlurm;
  }
  throw InputError(fmt::format("--engine {:?}: slurm or local is wanted", name));
}

int time_limit_minutes(double seconds, int shards) {
  constexpr int kAnew = 10;
  return kAnew + static_cast<int>(std::ceil(3.0 * seconds / shards / 60.0));
}

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) {
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return word + "'";
}

std::string job_digest(const Job& job) {
  std::string all = std::string(PALPATE_VERSION) + program_digest();
  for (const auto& [file, sha256] : job.input) {
    all += "\n" + sha256;
  }
  all += fmt::format("\n{}\n{}", fmt::join(job.build_flags, "\n"), job.shards);
  all += job.serve ? "\nserve" : "";
  Sha256 digest;
  digest.update(std::as_bytes(std::span(all)));
  return digest.hex().substr(0, 12);
}

// The codes are those of formats/base/error.h: 1 to 5 come again however often it is
// tried.
std::string shard_script(const Job& job) {
  return head(job, "One shard, by its number. Exit 75: try again.") +
         fmt::format(
             "shard=${{SLURM_ARRAY_TASK_ID:-${{1:?which shard}}}}\n"
             "{}\n"
             "if ! sha256sum --quiet --check inputs.sha256; then\n"
             "  echo 'palpate: the inputs are not those that were submitted' >&2\n"
             "  echo 2 > \"shard-$shard.failed\"\n"
             "  exit 2\n"
             "fi\n"
             "{}"
             "code=$?\n"
             "[ -e \"shard-$shard\" ] && exit 0\n"
             "if ((code >= 1 && code <= 5)); then\n"
             "  echo $code > \"shard-$shard.failed\"\n"
             "  exit $code\n"
             "fi\n"
             "exit 75\n",
             // A service finds out by itself that all is done.
             job.serve ? "rm -f \"shard-$shard\"" : "[ -e \"shard-$shard\" ] && exit 0",
             work_line(job));
}

std::string merge_script(const Job& job) {
  return head(job,
              "All shards in one database; asks again for those that are missing.") +
         fmt::format(
             "round=${{1:-0}}\n"
             "files=() missing=()\n"
             "for ((i = 0; i < shards; ++i)); do\n"
             "  files+=(\"shard-$i\")\n"
             "  [ -e \"shard-$i\" ] || missing+=(\"$i\")\n"
             "  if [ -e \"shard-$i.failed\" ] && [ ! -e \"shard-$i\" ]; then\n"
             "    echo \"palpate: shard $i failed, see $PWD/shard-$i.log\" >&2\n"
             "    exit \"$(cat \"shard-$i.failed\")\"\n"
             "  fi\n"
             "done\n"
             "output={}\n"
             "if ((${{#missing[@]}} > 0)) && [ ! -e \"$output\" ]; then\n"
             "  if ((round < {})); then\n"
             "    exec bash start.sh \"$(IFS=,; echo \"${{missing[*]}}\")\" $((round + "
             "1))\n"
             "  fi\n"
             "  echo \"palpate: shards ${{missing[*]}} are missing, see $PWD\" >&2\n"
             "  exit 75\n"
             "fi\n"
             "{}",
             job.serve ? shell_word(job.output.string()) : "", kMergeRetries,
             merge_line(job));
}

std::string start_script(const Job& job) {
  return head(job,
              "start.sh [LIST [ROUND]]: the listed shards, or all; then the merge.") +
         "list=${1:-$(seq -s, 0 $((shards - 1)))}\n"
         "round=${2:-0}\n"
         "rm -f shard-*.failed\n" +
         (job.engine == JobEngine::kSlurm ? slurm_start(job) : local_start(job));
}

void write_job(const Job& job) {
  std::error_code error;
  fs::create_directories(job.folder, error);
  if (error) {
    throw InputError(
        fmt::format("{}: cannot be made: {}", job.folder.string(), error.message()));
  }
  std::string inputs;
  for (const auto& [file, sha256] : job.input) {
    inputs += fmt::format("{}  {}\n", sha256, file.string());
  }
  write_text(job.folder / "inputs.sha256", inputs);
  write_text(job.folder / "shard.sh", shard_script(job));
  write_text(job.folder / "merge.sh", merge_script(job));
  write_text(job.folder / "start.sh", start_script(job));
}

}  // namespace palpate
