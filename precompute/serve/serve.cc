#include "precompute/serve/serve.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/sha256.h"
#include "formats/database/database_index.h"
#include "precompute/build/build.h"
#include "precompute/build/build_job.h"
#include "precompute/build/checkpoint.h"
#include "precompute/material/material_of_scene.h"
#include "precompute/process/failure_of.h"
#include "precompute/process/interrupt.h"
#include "precompute/process/parallel.h"
#include "precompute/process/patience.h"
#include "precompute/serve/answer_log.h"
#include "precompute/serve/answer_tally.h"
#include "precompute/serve/preliminary_answers.h"
#include "precompute/serve/service_sessions.h"
#include "precompute/serve/unit_claims.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kLookAround{200};  // for what other services have solved
constexpr milliseconds kFirstHand{3000};  // a runtime that starts a service joins it
constexpr std::int64_t kTheWholeFile = 999999;  // claimed by who puts it together

bool has_curve(const WorkUnitNode& node) {
  return node.failure.empty() && node.response.origin != ResponseOrigin::kNone;
}

// Whether the output is there and of this scene.
// @throws InputError if it is of another one.
bool is_computed_already(const BuildJob& job, const ServeOptions& options) {
  if (!fs::exists(options.output)) {
    return false;
  }
  const bool same =
      read_database(options.output).provenance.plan_sha256 == job.plan.digest;
  if (!same && !options.anew) {
    throw InputError(fmt::format(
        "{} is of another scene, mesh or program: --anew computes it again, -o writes "
        "another file",
        options.output.string()));
  }
  return same;
}

// One run over all the work that is left.
class Service {
 public:
  Service(const Scene& scene, const BuildJob& job, const Checkpoint& checkpoint,
          const ServeOptions& options, AnswerLog& log, const HandPlaces& hands)
      : scene_(scene),
        job_(job),
        checkpoint_(checkpoint),
        options_(options),
        log_(log),
        hands_(hands),
        tally_(job),
        board_(job.body.surface.position_m, preliminary_groups(scene, job), job.units),
        claims_(options.output.string() + ".partial") {}

  // @throws what a worker threw, Interrupted.
  void run(int workers, Progress& progress) {
    say("preliminary answers");
    take_what_others_solved();
    std::vector<std::thread> threads;
    for (int i = 0; i < workers; ++i) {
      threads.emplace_back([this] {
        until_done([this] {
          work_once();
        });
      });
    }
    until_done([&] {
      std::this_thread::sleep_for(kLookAround);
      keep_left();
      take_what_others_solved();
      if (!keeps_folder()) {
        over_ = true;
      }
      const std::size_t done = job_.units.size() - board_.unfinished();
      progress.advance(done, job_.units.size(), "units");
    });
    for (std::thread& thread : threads) {
      thread.join();
    }
    keep_left();
    if (failure_) {
      std::rethrow_exception(failure_);
    }
  }

  // Makes the folder of units and claims again if it was taken away. False, without a
  // folder, if that was done by another service that has put the file together.
  [[nodiscard]] bool keeps_folder() const {
    if (!checkpoint_.is_there()) {
      if (is_computed_already(job_, options_)) {
        return false;
      }
      checkpoint_.make();
    }
    return true;
  }

  // Whether this service is the one to put the file together.
  [[nodiscard]] bool claims_the_file() { return claims_.claim(kTheWholeFile); }

  void say(const std::string& stage) { log_.say(tally_.progress(stage)); }

 private:
  // What one thread throws ends all.
  void until_done(const std::function<void()>& step) {
    try {
      while (!over_ && board_.unfinished() > 0) {
        check_interrupted();
        step();
      }
    } catch (...) {
      const std::lock_guard lock(failure_mutex_);
      failure_ = failure_ ? failure_ : std::current_exception();
      over_ = true;
    }
  }

  void work_once() {
    const std::vector<HandPlace> hands = hands_.all();
    const bool expected = std::chrono::steady_clock::now() - began_ < kFirstHand;
    const NextWork work = board_.next(
        hands,
        [&](std::size_t unit) {
          return claims_.claim(job_.units[unit].index);
        },
        expected);
    if (work.group) {
      publish_preliminary(*work.group);
    } else if (work.unit) {
      solve(*work.unit);
    } else {
      std::this_thread::sleep_for(kLookAround);
    }
  }

  void publish_preliminary(std::size_t group) {
    publish({.quality = AnswerQuality::kPreliminary,
             .node = preliminary_answers(scene_, job_, board_.group(group))},
            "preliminary answers");
    board_.finish_group(group);
  }

  // The bits of a unit do not depend on who solves it, or beside what.
  void solve(std::size_t i) {
    const WorkUnit& unit = job_.units[i];
    if (auto kept = checkpoint_.load(unit.index)) {  // by somebody else meanwhile
      finish(i, *kept);
      return;
    }
    WorkUnitOutcome outcome;
    const std::string reason = failure_of("its unit", [&] {
      with_patience(options_.patience_s, "its unit", [&] {
        outcome = solve_unit(scene_, job_.body, job_.strategy, solver(), unit,
                             scene_.accuracy.solve == "all");
      });
    });
    if (!reason.empty()) {
      outcome = failed_unit(unit, job_.body.tool.size(), reason);
    } else if (!keep(outcome)) {
      const std::lock_guard lock(unkept_mutex_);
      unkept_.push_back(outcome);
    }
    finish(i, outcome);
  }

  // False where the disk does not take it.
  [[nodiscard]] bool keep(const WorkUnitOutcome& outcome) const {
    try {
      if (keeps_folder()) {
        checkpoint_.keep(outcome);
      }
      return true;
    } catch (const InputError&) {
      return false;
    } catch (const ResourceError&) {
      return false;
    }
  }

  void keep_left() {
    const std::lock_guard lock(unkept_mutex_);
    std::erase_if(unkept_, [&](const WorkUnitOutcome& outcome) {
      return keep(outcome);
    });
  }

  void finish(std::size_t i, const WorkUnitOutcome& outcome) {
    claims_.give_back(job_.units[i].index);
    board_.finish_unit(i);
    if (!outcome.is_check) {
      publish({.quality = AnswerQuality::kFinal, .node = outcome.node},
              "final answers");
    } else {
      say("checks");
    }
  }

  void publish(const ServedResponses& responses, const std::string& stage) {
    tally_.take(responses);
    log_.say(responses);
    say(stage);
  }

  void take_what_others_solved() {
    for (const std::size_t unit : board_.open_units()) {
      if (const auto kept = checkpoint_.load(job_.units[unit].index)) {
        finish(unit, *kept);
      }
    }
  }

  // Made when the first unit is solved: preliminary answers do not wait for it.
  const SceneSolver& solver() {
    std::call_once(solver_made_, [&] {
      Progress quiet(nullptr);
      solver_.emplace(scene_, job_.body, job_.strategy, job_.reachable, job_.reachable,
                      quiet);
      solver_->watch(
          [this](const SharedTool& tool, std::span<const PressedNode> nodes) {
            say_early(tool, nodes);
          });
    });
    return *solver_;
  }

  // Full presses of a unit that is still under way.
  void say_early(const SharedTool& tool, std::span<const PressedNode> nodes) {
    ServedResponses responses{.quality = AnswerQuality::kFinal, .node = {}};
    for (const PressedNode& node : nodes) {
      WorkUnitNode answer = answer_of(scene_, job_, tool, node);
      if (has_curve(answer)) {
        responses.node.push_back(std::move(answer));
      }
    }
    if (!responses.node.empty()) {
      publish(responses, "final answers");
    }
  }

  const Scene& scene_;
  const BuildJob& job_;
  const Checkpoint& checkpoint_;
  const ServeOptions& options_;
  AnswerLog& log_;
  const HandPlaces& hands_;
  AnswerTally tally_;
  WorkBoard board_;
  UnitClaims claims_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::once_flag solver_made_;
  std::optional<SceneSolver> solver_;
  std::atomic<bool> over_ = false;
  std::mutex unkept_mutex_;
  std::vector<WorkUnitOutcome> unkept_;  // what the disk did not take so far
  std::mutex failure_mutex_;
  std::exception_ptr failure_;
};

// E / (1 - nu^2) [Pa] of the body's own material at small strain.
double modulus_pa(const Scene& scene) {
  const auto own = std::find_if(scene.material.begin(), scene.material.end(),
                                [](const SceneMaterial& material) {
                                  return material.region == kBodyRegion;
                                });
  if (own == scene.material.end()) {
    return 0.0;
  }
  const Material material = make_material(*own);
  const double youngs_pa = small_youngs_modulus_pa(material);
  const double nu = 0.5 * youngs_pa / small_shear_modulus_pa(material) - 1.0;
  return youngs_pa / (1.0 - nu * nu);
}

ServedScene served(const Scene& scene, const BuildJob& job,
                   const ServeOptions& options) {
  return {.plan = job.plan,
          .reachable = job.reachable,
          .output = fs::absolute(options.output).string(),
          .nonlinear = job.strategy.nonlinear,
          .modulus_pa = modulus_pa(scene)};
}

// Drops units of another scene where that was asked for.
void prepare_folder(const JobDescription& plan, const ServeOptions& options) {
  if (!options.anew) {
    return;
  }
  try {
    (void)Checkpoint(options.output, plan, true, FolderUse::kShared);
  } catch (const InputError&) {
    std::error_code ignored;
    fs::remove_all(options.output.string() + ".partial", ignored);
  }
}

// Another service puts the file together; if it dies over that, this one does.
void wait_for_the_file(Service& service, const std::function<void()>& write) {
  while (service.keeps_folder()) {
    check_interrupted();
    if (service.claims_the_file()) {
      write();
      return;
    }
    std::this_thread::sleep_for(kLookAround);
  }
}

void compute(const Scene& scene, const BuildJob& job, const ServeOptions& options,
             AnswerLog& log, const HandPlaces& hands, Progress& progress) {
  const Checkpoint checkpoint(options.output, job.plan, true, FolderUse::kShared);
  Service service(scene, job, checkpoint, options, log, hands);
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  service.run(options.workers > 0 ? options.workers : static_cast<int>(cores),
              progress);
  service.say("database");
  wait_for_the_file(service, [&] {
    build(scene,
          {.output = options.output,
           .resume = true,
           .repair = options.repair,
           .precision = options.precision,
           .workers = options.workers,
           .patience_s = options.patience_s,
           .folder_use = FolderUse::kShared},
          progress);
  });
}

}  // namespace

void serve(const Scene& scene, const ServeOptions& options, Progress& progress) {
  const Workers workers(options.workers);
  progress.stage("body");
  const BuildJob job = build_job(scene, {.repair = options.repair});
  const bool computed = is_computed_already(job, options);
  prepare_folder(job.plan, options);
  AnswerLog log(served(scene, job, options));
  HandPlaces hands;
  const ServiceSessions sessions(options.socket, log, hands);
  progress.stage("answers");
  try {
    if (!computed) {
      compute(scene, job, options, log, hands, progress);
    }
    log.say(ServedEnd{.file = fs::absolute(options.output).string(), .failure = {}});
    progress.finish();
  } catch (const Interrupted&) {
    throw;  // who has joined may join again
  } catch (const std::exception& error) {
    log.say(ServedEnd{.file = {}, .failure = error.what()});
    throw;
  }
}

}  // namespace palpate
