// palpate-precompute submit: a build shared out among machines.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/base/sha256.h"
#include "formats/database/rounded_database.h"
#include "precompute/build/job_scripts.h"
#include "precompute/build/plan.h"
#include "precompute/command/commands.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct SubmitFlags {
  std::string scene;
  std::string output;
  std::string engine;
  int nodes = 1;
  int shards = 0;
  int workers = 0;
  std::string repair = "off";
  std::string precision;
  bool solve_all = false;
  bool serve = false;
  bool run = false;
  bool json = false;
};

// Every file that a build of the scene reads.
std::vector<std::pair<fs::path, std::string>> inputs_of(const fs::path& file,
                                                        const Scene& scene) {
  std::vector<fs::path> files{file, scene.mesh};
  for (const SceneInclusion& inclusion : scene.inclusion) {
    if (inclusion.mesh) {
      files.push_back(inclusion.mesh->file);
    }
  }
  for (const SceneMesh& mesh : scene.tool_mesh) {
    if (!mesh.file.empty()) {
      files.push_back(mesh.file);
    }
  }
  std::vector<std::pair<fs::path, std::string>> inputs;
  for (const fs::path& input : files) {
    inputs.emplace_back(fs::absolute(input), sha256_of_file(input));
  }
  return inputs;
}

Job job_of(const SubmitFlags& flags, const Scene& scene, const PlanReport& plan) {
  Job job;
  job.engine = job_engine(flags.engine);
  job.serve = flags.serve;
  job.scene = fs::absolute(flags.scene);
  job.output = fs::absolute(flags.output);
  job.tools = fs::read_symlink("/proc/self/exe").parent_path();
  job.input = inputs_of(flags.scene, scene);
  if (flags.repair != "off") {
    job.build_flags = {"--repair", flags.repair};
  }
  if (flags.solve_all) {
    job.build_flags.emplace_back("--solve-all");
  }
  if (!flags.precision.empty()) {
    static_cast<void>(precision_of(flags.precision));
    auto& of = job.serve ? job.build_flags : job.merge_flags;
    of.insert(of.end(), {"--precision", flags.precision});
  }
  job.shards = flags.serve ? flags.nodes
                           : std::max(2, flags.shards > 0 ? flags.shards : flags.nodes);
  job.at_once = flags.nodes;
  job.workers = flags.workers;
  job.minutes = time_limit_minutes(plan.seconds, job.shards);
  job.memory_mb =
      200 +
      static_cast<int>(std::ceil(1.5e-6 * static_cast<double>(plan.peak_memory_bytes)));
  job.folder = fs::path(job.output.string() + ".jobs") / job_digest(job);
  return job;
}

// Runs start.sh, its output on our own. @returns its exit code.
int run_start(const Job& job) {
  const std::string line =
      "exec bash " + shell_word((job.folder / "start.sh").string());
  const int status = std::system(line.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

void print_job(const Job& job, const PlanReport& plan, const SubmitFlags& flags) {
  if (flags.json) {
    fmt::print("{}\n", json_text(nlohmann::ordered_json{
                           {"folder", job.folder.string()},
                           {"start", (job.folder / "start.sh").string()},
                           {"engine", flags.engine},
                           {job.serve ? "services" : "shards", job.shards},
                           {"at_once", job.at_once},
                           {"seconds", plan.seconds},
                           {"shard_minutes_limit", job.minutes},
                           {"shard_memory_mb", job.memory_mb}}));
    return;
  }
  if (job.serve) {
    fmt::print("services      {} that share {} units\n", job.shards, plan.units);
  } else {
    fmt::print("shards        {} of {} units, {} at once\n", job.shards, plan.units,
               job.at_once);
  }
  fmt::print("time          {:.3g} s of one machine; limit of a shard {} min, {} MB\n",
             plan.seconds, job.minutes, job.memory_mb);
  fmt::print("scripts       {}\n", job.folder.string());
  if (!flags.run) {
    fmt::print("start with    bash {}\n",
               shell_word((job.folder / "start.sh").string()));
  }
}

void run_submit(const SubmitFlags& flags) {
  note_interrupts();
  static_cast<void>(job_engine(flags.engine));
  if (flags.serve && (flags.solve_all || flags.shards > 0)) {
    throw InputError(
        "--serve: services take units as they come, and solve what a build does: "
        "leave out --shards and --solve-all");
  }
  const Scene scene = read_scene(flags.scene);
  Progress progress(stderr);
  const PlanReport report = plan(scene,
                                 {.solve_all = flags.solve_all,
                                  .workers = flags.workers,
                                  .repair = repair_mode(flags.repair)},
                                 progress);
  const Job job = job_of(flags, scene, report);
  write_job(job);
  print_job(job, report, flags);
  std::fflush(stdout);
  if (flags.run) {
    const int code = run_start(job);
    if (code != 0) {
      throw Error(fmt::format("{} ended with exit code {}; its logs are beside it",
                              (job.folder / "start.sh").string(), code),
                  code);
    }
  }
}

}  // namespace

void add_submit_command(Command app) {
  Command command = app.add_subcommand(
      "submit", "Share a build out among machines: job scripts, shards and merge");
  auto flags = std::make_shared<SubmitFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  command.add_option("-o,--output", flags->output, "Response database to write (HDF5)")
      .required();
  command
      .add_option("--engine", flags->engine,
                  "slurm: a job array and a merge after it; local: this machine")
      .required();
  command
      .add_option("--nodes", flags->nodes, "Shards under way at a time, each a machine")
      .in_range(1, 10000);
  command
      .add_option("--shards", flags->shards,
                  "Parts of the work, at least 2; 0: as many as --nodes")
      .in_range(0, 10000);
  command
      .add_option("--threads", flags->workers,
                  "Threads of a shard; 0: all cores of its machine")
      .in_range(0, 1024);
  command.add_option("--repair", flags->repair,
                     "off, safe or wrap: mend the body's surface first");
  command.add_option("--precision", flags->precision,
                     "float64, float32 or int16, as of build");
  command.add_flag("--solve-all", flags->solve_all,
                   "Solve every node, interpolate none");
  command.add_flag(
      "--serve", flags->serve,
      "Services of the scene instead of shards, --nodes of them: they share "
      "its units with each other and with one that is started by palpate-run "
      "view SCENE.toml -o OUTPUT, which has all that they compute");
  command.add_flag("--run", flags->run, "Start it: submit the jobs, or run them here");
  command.add_flag("--json", flags->json, "Print what was written as one JSON object");
  command.callback([flags] {
    run_submit(*flags);
  });
}

}  // namespace palpate
