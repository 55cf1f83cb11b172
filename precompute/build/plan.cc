#include "precompute/build/plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "formats/base/quantile.h"
#include "formats/base/stopwatch.h"
#include "formats/database/error_calibration.h"
#include "precompute/build/plan_coupling.h"
#include "precompute/build/plan_cut_outs.h"
#include "precompute/build/plan_left_out.h"
#include "precompute/build/plan_relaxation.h"
#include "precompute/build/plan_shared_mesh.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/cluster.h"
#include "precompute/press/compliance_sample.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/press/press_cost.h"
#include "precompute/press/scene_solver.h"
#include "precompute/press/work_unit_solver.h"
#include "precompute/process/parallel.h"
#include "precompute/process/peak_memory.h"

namespace palpate {
namespace {

// What would take longer is extrapolated from something smaller, so that a plan takes
// seconds.
constexpr double kChecksCpuS = 2.0;
constexpr double kGroupsS = 3.0;   // of one kind; more groups are timed until then
constexpr double kPressesS = 7.0;  // nonlinear ones, which differ more
// A nonlinear check beside the median press: at more depths and to tighter tolerances.
// A gel cylinder's take about 1.7 times as long (MEASURED.md), hard ones more.
constexpr double kCheckTimes = 2.0;
// A press that a build chooses beside one anywhere: what is unlike its neighbours is
// solved, and that is harder.
constexpr double kChosenTimes = 1.2;
constexpr double kCheckMemory = 1.5;  // chosen where they were on finer meshes
constexpr std::size_t kMostBatches = 8;

class Planner {
 public:
  Planner(const Scene& scene, const PlanOptions& options, std::size_t workers,
          Progress& progress)
      : scene_(scene),
        repair_(options.repair),
        solve_all_(options.solve_all || scene.accuracy.solve == "all"),
        workers_(workers),
        progress_(progress) {}

  PlanReport run() {
    describe_scene();
    if (strategy_.cut_out) {
      plan_cut_outs(scene_, body_, strategy_, reachable_, units_, workers_, progress_,
                    report_);
    } else {
      time_whole_bodies();
    }
    count_memory();
    count_responses();
    report_.left_out = left_out_of(scene_, strategy_, report_);
    for (const PlanCost& cost : report_.cost) {
      report_.seconds += cost.seconds;
    }
    return std::move(report_);
  }

 private:
  using Group = std::vector<std::int32_t>;
  void describe_scene();
  void time_whole_bodies() {
    if (strategy_.shared_mesh) {
      time_shared_mesh();
    } else {
      time_linear_on_own_meshes();
    }
    plan_relaxation(scene_, report_);
    time_full();
    time_checks();
    plan_coupling(scene_, body_, reachable_, workers_, progress_, report_);
  }
  void time_shared_mesh();
  void time_linear_on_own_meshes();
  void time_full();
  void time_checks();
  void count_memory();
  void count_responses();

  // Own meshes for groups of vertices, as many at once as there are workers, until that
  // takes a while; of `count` groups. @param times longer than a timed one each takes.
  // Returns the errors that are estimated of these.
  std::vector<double> time_own_meshes(const std::string& work,
                                      const std::vector<Group>& groups,
                                      std::size_t count, const ContactFocus& focus,
                                      bool nonlinear, double times = 1.0);
  [[nodiscard]] std::vector<const WorkUnit*> clusters() const;
  [[nodiscard]] std::size_t full_of(const WorkUnit& cluster) const;
  // Whether a build will probably solve every vertex without a linear press before.
  [[nodiscard]] bool all_solved_alone() const {
    const auto all = clusters();
    return strategy_.nonlinear && std::all_of(all.begin(), all.end(), [&](auto* unit) {
             return full_of(*unit) == unit->vertex.size();
           });
  }
  [[nodiscard]] std::vector<Group> some_groups(
      const std::function<std::vector<Group>(const WorkUnit&)>& groups_of) const;

  const Scene& scene_;
  RepairMode repair_;
  bool solve_all_;
  std::size_t workers_;
  Progress& progress_;
  BodySource body_;
  std::vector<std::int32_t> reachable_;
  PressStrategy strategy_;
  std::vector<WorkUnit> units_;
  PlanReport report_;
  // Stays, as in a build, while presses on own meshes are timed.
  std::optional<PlanSharedMesh> shared_;
  std::int64_t body_bytes_ = 0;  // before anything is meshed
  double press_s_ = 0.0;         // wall time of a nonlinear press, all workers busy
  // Linear presses outside the budget, which are done again on meshes of their own.
  double again_share_ = 0.0;
};

std::vector<const WorkUnit*> Planner::clusters() const {
  std::vector<const WorkUnit*> clusters;
  for (const WorkUnit& unit : units_) {
    if (!unit.is_check) {
      clusters.push_back(&unit);
    }
  }
  return clusters;
}

std::size_t Planner::full_of(const WorkUnit& cluster) const {
  if (strategy_.linear_is_full) {
    return static_cast<std::size_t>(
        std::lround(again_share_ * static_cast<double>(cluster.vertex.size())));
  }
  return solve_all_ ? cluster.vertex.size()
                    : expected_samples(cluster.vertex.size(), scene_.force_relative);
}

void Planner::describe_scene() {
  progress_.stage("body");
  const double seconds = seconds_of([&] {
    body_ = read_body(scene_, repair_);
    reachable_ = reachable_vertices(scene_, body_);
    strategy_ = choose_strategy(scene_, body_, reachable_);
    units_ = units_of(scene_, body_, reachable_);
  });
  report_.cost.push_back(cost_once("read and check the body", seconds));
  body_bytes_ = peak_memory_bytes();
  report_.nodes = body_.surface.position_m.rows();
  report_.reachable = static_cast<std::int64_t>(reachable_.size());
  for (Eigen::Index v = 0; v < body_.surface.position_m.rows(); ++v) {
    report_.held += is_held(scene_, body_.surface.position_m.row(v).transpose());
  }
  report_.outside_reach = report_.nodes - report_.reachable - report_.held;
  report_.tools = static_cast<std::int64_t>(body_.tool.size());
  report_.units = static_cast<std::int64_t>(units_.size());
  report_.checks = std::ranges::count(units_, true, &WorkUnit::is_check);
  report_.nonlinear = strategy_.nonlinear;
  report_.shared_mesh = strategy_.shared_mesh;
  report_.cut_out = strategy_.cut_out;
  const bool one_mesh = strategy_.shared_mesh || strategy_.cut_out;
  report_.graded = strategy_.graded && !strategy_.linear_is_full;
  report_.subdivisions = one_mesh ? strategy_.subdivisions : 0;
  report_.spacing_m = one_mesh ? strategy_.spacing_m : 0.5 * strategy_.focus.finest_m;
  report_.depths = scene_.accuracy.depths;
  report_.nonlinear_depths =
      strategy_.nonlinear ? nonlinear_depths(scene_.accuracy) : 0;
  report_.notes = body_.notes;
  for (const auto& more : {support_notes(scene_, body_.surface), strategy_.notes}) {
    report_.notes.insert(report_.notes.end(), more.begin(), more.end());
  }
}

void Planner::time_shared_mesh() {
  shared_.emplace(scene_, body_, strategy_, reachable_, workers_, progress_, report_);
  if (strategy_.linear_is_full && strategy_.graded) {
    again_share_ = shared_->share_outside_budget();
  }
  if (strategy_.nonlinear && !strategy_.graded) {
    std::size_t count = 0;
    for (const WorkUnit* cluster : clusters()) {
      count += full_of(*cluster);
    }
    shared_->time_nonlinear(count * body_.tool.size());
  }
}

std::vector<Planner::Group> Planner::some_groups(
    const std::function<std::vector<Group>(const WorkUnit&)>& groups_of) const {
  std::vector<Group> some;
  const std::vector<const WorkUnit*> all = clusters();
  for (std::size_t batch = 0; batch < kMostBatches; ++batch) {
    for (std::size_t w = 0; w < workers_; ++w) {
      const std::size_t place = 2 * (w * kMostBatches + batch) + 1;
      const std::size_t places = 2 * workers_ * kMostBatches;
      const auto groups = groups_of(*all[place * all.size() / places]);
      const Group& group = groups[place * groups.size() / places];
      if (std::find(some.begin(), some.end(), group) == some.end()) {
        some.push_back(group);
      }
    }
  }
  return some;
}

std::vector<double> Planner::time_own_meshes(const std::string& work,
                                             const std::vector<Group>& groups,
                                             std::size_t count,
                                             const ContactFocus& focus, bool nonlinear,
                                             double times) {
  progress_.stage("some of: " + work);
  const SharedTool& tool = body_.tool.front();
  std::vector<std::vector<PressedNode>> pressed(groups.size());
  std::vector<double> took_s(groups.size());
  std::size_t timed = 0;
  double seconds = 0.0;  // of all workers together
  while (timed < groups.size() && seconds < (nonlinear ? kPressesS : kGroupsS)) {
    const std::size_t batch = std::min(workers_, groups.size() - timed);
    in_parallel(batch, [&](std::size_t b) {
      const std::size_t i = timed + b;
      took_s[i] = seconds_of([&] {
        pressed[i] = press_on_own_mesh(scene_, body_, tool, groups[i], focus,
                                       {.nonlinear = nonlinear,
                                        .options = nonlinear_options(scene_, tool),
                                        .probe = strategy_.nonlinear});
      });
    });
    for (std::size_t b = 0; b < batch; ++b) {
      seconds += took_s[timed++] / static_cast<double>(workers_);
    }
  }
  took_s.resize(timed);
  report_.cost.push_back(
      cost_of_all(work, count * body_.tool.size(), timed, seconds, times));
  if (nonlinear) {
    // Half of them take less: those that fail cost a check no more than its node.
    std::ranges::sort(took_s);
    press_s_ = quantile(took_s, 0.5) / static_cast<double>(workers_);
  }
  std::vector<double> error;
  for (const auto& group : pressed) {
    for (const PressedNode& node : group) {
      error.push_back(to_response(node.indentation, node.path, scene_.force_relative)
                          .error_relative);
    }
  }
  return error;
}

void Planner::time_linear_on_own_meshes() {
  const auto groups_of = [&](const WorkUnit& unit) {
    return group_vertices(body_.surface, unit.vertex, strategy_.focus);
  };
  std::size_t count = 0;
  for (const WorkUnit* cluster : clusters()) {
    count += groups_of(*cluster).size();
  }
  const auto groups = some_groups(groups_of);
  const BodyModel model =
      make_own_model(scene_, body_, groups.front(), strategy_.focus);
  report_.tets = model.mesh.tet.rows();
  report_.unknowns = model.supports.free;
  if (all_solved_alone()) {
    return;
  }
  const std::vector<double> error =
      time_own_meshes("groups of linear presses on meshes of their own", groups, count,
                      strategy_.focus, false);
  if (strategy_.linear_is_full) {
    // Where linear is all, presses outside the budget are made again, finer.
    const auto outside = std::ranges::count_if(error, [&](double e) {
      return kLeastErrorFactor * e > scene_.force_relative;
    });
    again_share_ = static_cast<double>(outside) / static_cast<double>(error.size());
  }
}

void Planner::time_full() {
  if (!strategy_.graded) {
    return;
  }
  // Samples come in rounds; neighbours of a round share a mesh. What is outside the
  // budget lies side by side.
  const bool in_rounds = !strategy_.linear_is_full && !solve_all_;
  const auto groups_of = [&](const WorkUnit& unit) {
    return group_presses(
        body_.surface,
        in_rounds ? spread_over(unit.vertex, kFirstSamples) : unit.vertex,
        strategy_.focus, strategy_.nonlinear);
  };
  double count = 0.0;
  for (const WorkUnit* cluster : clusters()) {
    const auto groups = groups_of(*cluster);
    std::size_t vertices = 0;
    for (const auto& group : groups) {
      vertices += group.size();
    }
    count += static_cast<double>(groups.size() * full_of(*cluster)) /
             static_cast<double>(vertices);
  }
  if (count < 0.5) {
    return;
  }
  const bool finer_still = strategy_.linear_is_full && !strategy_.shared_mesh;
  (void)time_own_meshes(
      strategy_.linear_is_full ? "groups of presses outside the budget, on finer meshes"
                               : "groups of full presses on meshes of their own",
      some_groups(groups_of), static_cast<std::size_t>(std::lround(count)),
      finer_still ? finer(strategy_.focus, kFinerStep) : strategy_.focus,
      strategy_.nonlinear, strategy_.nonlinear && in_rounds ? kChosenTimes : 1.0);
}

void Planner::time_checks() {
  std::vector<Group> checks;
  for (const WorkUnit& unit : units_) {
    if (unit.is_check) {
      checks.push_back(unit.vertex);
    }
  }
  if (checks.empty()) {
    return;
  }
  const std::size_t count = checks.size();
  if (press_s_ > 0.0) {  // of full presses, more than would be timed here
    report_.cost.push_back(
        cost_of_all("checks", count * body_.tool.size(), 1, press_s_, kCheckTimes));
    return;
  }
  // A linear press costs as its factor and columns do.
  const ContactFocus fine = finer(strategy_.focus, kLinearCheckTimesFiner);
  const MeshWork here = own_mesh_work(scene_, body_, checks.front(), strategy_.focus);
  const MeshWork there = own_mesh_work(scene_, body_, checks.front(), fine);
  const bool affordable = !strategy_.nonlinear && expected_cpu_s(there) < kChecksCpuS;
  const double times = affordable ? 1.0
                       : strategy_.nonlinear
                           ? kCheckTimes
                           : expected_cpu_s(there) / expected_cpu_s(here);
  (void)time_own_meshes("checks", checks, count, affordable ? fine : strategy_.focus,
                        strategy_.nonlinear, times);
}

// Every kind of work was done by all workers at once, beside what all of them share.
void Planner::count_memory() {
  const std::int64_t peak = peak_memory_bytes();
  const double pressed = static_cast<double>(peak - body_bytes_);
  const double most =
      static_cast<double>(body_bytes_) +
      (strategy_.nonlinear && report_.checks > 0 ? kCheckMemory : 1.0) * pressed;
  report_.peak_memory_bytes =
      std::max(report_.peak_memory_bytes, static_cast<std::int64_t>(most));
}

void Planner::count_responses() {
  const std::int64_t all = report_.reachable * report_.tools;
  report_.solved_at_least = report_.solved_expected = all;
  if (!strategy_.linear_is_full && !solve_all_) {
    report_.solved_at_least = report_.solved_expected = 0;
    for (const WorkUnit* cluster : clusters()) {
      report_.solved_at_least +=
          report_.tools *
          static_cast<std::int64_t>(std::min(kFirstSamples, cluster->vertex.size()));
      report_.solved_expected +=
          report_.tools * static_cast<std::int64_t>(full_of(*cluster));
    }
  }
  report_.interpolated_expected = all - report_.solved_expected;
}

}  // namespace

PlanReport plan(const Scene& scene, const PlanOptions& options, Progress& progress) {
  const Workers workers(options.workers);
  const auto began = std::chrono::steady_clock::now();
  PlanReport report = Planner(scene, options, Workers::count(), progress).run();
  report.plan_seconds = seconds_since(began);
  progress.finish();
  return report;
}

}  // namespace palpate
