#include "precompute/plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include "formats/stopwatch.h"
#include "precompute/column_sample.h"
#include "precompute/machine_memory.h"
#include "precompute/node_press.h"
#include "precompute/peak_memory.h"
#include "precompute/plan_cut_outs.h"
#include "precompute/plan_left_out.h"
#include "precompute/press_cost.h"
#include "precompute/scene_solver.h"
#include "precompute/share_above.h"
#include "precompute/unit_solver.h"

namespace palpate {
namespace {

constexpr std::size_t kSamples = 3;  // that every worker presses
// What would take longer is told from something smaller, so that a plan takes seconds.
constexpr double kFactorCpuS = 1.5;
constexpr double kColumnsCpuS = 2.0;
constexpr double kChecksCpuS = 2.0;

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
    if (approach_.cut_out) {
      plan_cut_outs(scene_, body_, approach_, reachable_, units_, workers_, progress_,
                    report_);
    } else {
      time_whole_bodies();
    }
    count_responses();
    report_.left_out = left_out_of(scene_, approach_, report_);
    for (const PlanCost& cost : report_.cost) {
      report_.seconds += cost.seconds;
    }
    return std::move(report_);
  }

 private:
  void describe_scene();
  void time_whole_bodies() {
    if (approach_.shared_mesh) {
      time_shared_mesh();
    } else {
      time_cheap_on_own_meshes();
    }
    time_good();
    time_checks();
  }
  void time_shared_mesh();
  [[nodiscard]] SurfaceMesh sample_surface() const;
  void time_columns(std::span<const PressedNode> placed, std::size_t columns);
  void time_linear_presses(const std::vector<std::int32_t>& samples);
  void time_nonlinear_on_shared_mesh(const std::vector<std::int32_t>& samples);
  void time_cheap_on_own_meshes();
  void time_good();
  void time_checks();
  void count_responses();

  // What is done once, timed as it is.
  void once(const std::string& work, double seconds) {
    report_.cost.push_back({work, 1, 1, seconds, seconds});
  }
  // Done once, timed on something smaller.
  void once_scaled(const std::string& work, double seconds, double times) {
    report_.cost.push_back({work, 1, 1, seconds, times * seconds});
  }
  // Some of many, timed; one of the others takes so many times longer.
  void extrapolate(const std::string& work, std::size_t count, std::size_t timed,
                   double seconds, double times = 1.0) {
    const double share = static_cast<double>(count) / static_cast<double>(timed);
    report_.cost.push_back({work, static_cast<std::int64_t>(count),
                            static_cast<std::int64_t>(timed), seconds,
                            times * share * seconds});
  }
  // Own meshes for vertices of several territories, as many at once as there are
  // workers; of `count` groups of vertices.
  void time_own_meshes(const std::string& work,
                       const std::vector<std::vector<std::int32_t>>& groups,
                       std::size_t count, const ContactFocus& focus, bool nonlinear,
                       double times = 1.0);
  [[nodiscard]] std::vector<const Unit*> territories() const;
  [[nodiscard]] std::size_t good_of(const Unit& territory) const;
  [[nodiscard]] std::vector<std::vector<std::int32_t>> first_groups(
      const std::function<std::vector<std::vector<std::int32_t>>(const Unit&)>&) const;

  const Scene& scene_;
  RepairMode repair_;
  bool solve_all_;
  std::size_t workers_;
  Progress& progress_;
  BodySource body_;
  std::vector<std::int32_t> reachable_;
  Approach approach_;
  std::vector<Unit> units_;
  PlanReport report_;
  // What all workers share stays, as in a build, while presses on own meshes are timed.
  std::optional<BodyModel> shared_;
  std::optional<SurfaceCompliance> compliance_;
  // Cheap presses outside the budget, which are done again on meshes of their own.
  double again_share_ = 0.0;
  // Triangles of the shared surface over those of the one that is timed in its place.
  double times_larger_ = 1.0;
};

std::vector<const Unit*> Planner::territories() const {
  std::vector<const Unit*> territories;
  for (const Unit& unit : units_) {
    if (!unit.is_check) {
      territories.push_back(&unit);
    }
  }
  return territories;
}

std::size_t Planner::good_of(const Unit& territory) const {
  if (approach_.cheap_is_good) {
    return static_cast<std::size_t>(
        std::lround(again_share_ * static_cast<double>(territory.vertex.size())));
  }
  return solve_all_ ? territory.vertex.size()
                    : std::min(expected_samples(scene_.force_relative),
                               territory.vertex.size());
}

void Planner::describe_scene() {
  progress_.stage("body");
  once("read and check the body", seconds_of([&] {
         body_ = read_body(scene_, repair_);
         reachable_ = reachable_vertices(scene_, body_);
         approach_ = choose_approach(scene_, body_, reachable_);
         units_ = units_of(scene_, body_, reachable_);
       }));
  report_.nodes = body_.surface.position_m.rows();
  report_.reachable = static_cast<std::int64_t>(reachable_.size());
  for (Eigen::Index v = 0; v < body_.surface.position_m.rows(); ++v) {
    report_.held += is_held(scene_, body_.surface.position_m.row(v).transpose());
  }
  report_.outside_reach = report_.nodes - report_.reachable - report_.held;
  report_.tools = static_cast<std::int64_t>(body_.tool.size());
  report_.units = static_cast<std::int64_t>(units_.size());
  report_.checks = std::count_if(units_.begin(), units_.end(), [](const Unit& unit) {
    return unit.is_check;
  });
  report_.nonlinear = approach_.nonlinear;
  report_.shared_mesh = approach_.shared_mesh;
  report_.cut_out = approach_.cut_out;
  const bool one_mesh = approach_.shared_mesh || approach_.cut_out;
  report_.graded = approach_.graded && !approach_.cheap_is_good;
  report_.subdivisions = one_mesh ? approach_.subdivisions : 0;
  report_.spacing_m = one_mesh ? approach_.spacing_m : 0.5 * approach_.focus.finest_m;
  report_.depths = scene_.accuracy.depths;
  report_.nonlinear_depths =
      approach_.nonlinear ? nonlinear_depths(scene_.accuracy.depths) : 0;
  report_.notes = body_.notes;
  report_.notes.insert(report_.notes.end(), approach_.notes.begin(),
                       approach_.notes.end());
}

// The shared surface, or one so much coarser that its factor is made in seconds.
SurfaceMesh Planner::sample_surface() const {
  const auto seconds = [](const SurfaceMesh& surface) {
    return expected_cpu_s({static_cast<double>(surface.triangle.rows()), 0.0});
  };
  SurfaceMesh surface = approach_.surface;
  const double reach_m = touched_radius_m(scene_, body_, approach_.spacing_m);
  for (double spacing_m = approach_.spacing_m; seconds(surface) > kFactorCpuS;) {
    spacing_m *= 1.5;
    const Eigen::Index before = surface.triangle.rows();
    surface = pressed_surface(body_, reachable_, spacing_m, reach_m).surface;
    if (surface.triangle.rows() == before ||
        surface.triangle.rows() == body_.surface.triangle.rows()) {
      break;
    }
  }
  return surface;
}

void Planner::time_shared_mesh() {
  progress_.stage("shared mesh and factor");
  const SurfaceMesh surface = sample_surface();
  times_larger_ = static_cast<double>(approach_.surface.triangle.rows()) /
                  static_cast<double>(surface.triangle.rows());
  const double seconds = seconds_of([&] {
    shared_.emplace(make_body_model(scene_, body_, surface));
  });
  shared_->contact_spacing_m = approach_.spacing_m * std::sqrt(times_larger_);
  once_scaled("shared mesh and factor", seconds,
              expected_cpu_s({times_larger_, 0.0}) / expected_cpu_s({1.0, 0.0}));
  report_.tets = static_cast<std::int64_t>(
      times_larger_ * static_cast<double>(shared_->mesh.tet.rows()));
  report_.unknowns = static_cast<std::int64_t>(
      times_larger_ * static_cast<double>(shared_->supports.free));
  if (times_larger_ > 1.0) {
    require_memory(approach_.surface.triangle.rows());
    report_.peak_memory_bytes = static_cast<std::int64_t>(
        expected_memory_bytes(approach_.surface.triangle.rows()));
  }
  std::vector<PressedNode> placed;
  once("place the tools", seconds_of([&] {
         for (const SharedTool& tool : body_.tool) {
           for (const std::int32_t v : reachable_) {
             placed.push_back(placed_node(scene_, body_, *shared_, tool, v));
           }
         }
       }));
  const double reach_m = touched_radius_m(scene_, body_, approach_.spacing_m);
  const auto near = [&](const SurfaceMesh& mesh) {
    return static_cast<double>(contact_nodes_near(mesh, body_, reachable_, reach_m));
  };
  const ColumnSample all = column_sample(*shared_, placed, {});
  const double more_columns =
      times_larger_ > 1.0 ? near(approach_.surface) / std::max(near(surface), 1.0)
                          : 1.0;
  time_columns(placed, static_cast<std::size_t>(
                           std::lround(more_columns * static_cast<double>(all.all))));
}

void Planner::time_columns(std::span<const PressedNode> placed, std::size_t columns) {
  progress_.stage("a few columns");
  report_.columns = static_cast<std::int64_t>(columns);
  const double triangles = static_cast<double>(approach_.surface.triangle.rows());
  // As many vertices' columns as take seconds, one vertex's at least.
  std::vector<std::int32_t> samples;
  ColumnSample sample;
  for (std::size_t count = kSamples * workers_; count > 0; --count) {
    samples = spread_over(reachable_, count);
    sample = column_sample(*shared_, placed, samples);
    if (expected_cpu_s({triangles / times_larger_,
                        static_cast<double>(sample.solved)}) < kColumnsCpuS) {
      break;
    }
  }
  if (sample.solved == 0) {
    return;
  }
  const double none = seconds_of([&] {
    (void)compliance_of(*shared_, placed, std::vector<char>(sample.wanted.size(), 0),
                        nullptr);
  });
  const double some = seconds_of([&] {
    compliance_.emplace(compliance_of(*shared_, placed, sample.wanted,
                                      [&](std::size_t done, std::size_t total) {
                                        progress_.advance(done, total, "columns");
                                      }));
  });
  once("find pairs of near contact nodes", none);
  extrapolate("columns of the surface compliance", columns, sample.solved,
              std::max(some - none, 0.0),
              expected_column_cpu_s(times_larger_) / expected_column_cpu_s(1.0));
  time_linear_presses(samples);
  if (approach_.nonlinear && !approach_.graded) {
    time_nonlinear_on_shared_mesh(samples);
  }
}

void Planner::time_linear_presses(const std::vector<std::int32_t>& samples) {
  progress_.stage("a few linear presses");
  std::vector<double> error(samples.size(), 0.0);
  const double seconds = seconds_of([&] {
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
      PressedNode node =
          placed_node(scene_, body_, *shared_, body_.tool.front(), samples[i]);
      press_linear(*shared_, *compliance_, node);
      if (node.indentation.sample.size() > 1) {
        error[i] = to_response(node.indentation, node.path, scene_.force_relative)
                       .error_relative;
      }
    });
  });
  extrapolate("linear presses", reachable_.size() * body_.tool.size(), samples.size(),
              seconds);
  if (approach_.cheap_is_good && approach_.graded) {
    again_share_ = share_above(error, scene_.force_relative);
  }
}

void Planner::time_nonlinear_on_shared_mesh(const std::vector<std::int32_t>& samples) {
  progress_.stage("a few nonlinear presses");
  const SharedTool& tool = body_.tool.front();
  const double seconds = seconds_of([&] {
    tbb::parallel_for(std::size_t{0}, workers_, [&](std::size_t w) {
      std::vector<PressedNode> nodes;
      if (w < samples.size()) {
        nodes.push_back(placed_node(scene_, body_, *shared_, tool, samples[w]));
        press_linear(*shared_, *compliance_, nodes.back());
      }
      press_nonlinear(*shared_, *compliance_, nodes, nonlinear_options(scene_, tool),
                      false);
    });
  });
  std::size_t count = 0;
  for (const Unit* territory : territories()) {
    count += good_of(*territory);
  }
  extrapolate("nonlinear presses", count * body_.tool.size(),
              std::min(samples.size(), workers_), seconds,
              expected_column_cpu_s(times_larger_) / expected_column_cpu_s(1.0));
}

std::vector<std::vector<std::int32_t>> Planner::first_groups(
    const std::function<std::vector<std::vector<std::int32_t>>(const Unit&)>& groups_of)
    const {
  std::vector<std::vector<std::int32_t>> some;
  const std::vector<const Unit*> all = territories();
  for (std::size_t w = 0; w < workers_; ++w) {
    const Unit& unit = *all[(2 * w + 1) * all.size() / (2 * workers_)];
    const auto groups = groups_of(unit);
    some.push_back(groups[(2 * w + 1) * groups.size() / (2 * workers_)]);
  }
  return some;
}

void Planner::time_own_meshes(const std::string& work,
                              const std::vector<std::vector<std::int32_t>>& groups,
                              std::size_t count, const ContactFocus& focus,
                              bool nonlinear, double times) {
  progress_.stage("one of: " + work);
  const double seconds = seconds_of([&] {
    tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t i) {
      const SharedTool& tool = body_.tool.front();
      (void)press_on_own_mesh(
          scene_, body_, tool, groups[i], focus,
          {.nonlinear = nonlinear, .options = nonlinear_options(scene_, tool)});
    });
  });
  extrapolate(work, count * body_.tool.size(), groups.size(), seconds, times);
}

void Planner::time_cheap_on_own_meshes() {
  const auto groups_of = [&](const Unit& unit) {
    return group_vertices(body_.surface, unit.vertex, approach_.focus);
  };
  std::size_t count = 0;
  for (const Unit* territory : territories()) {
    count += groups_of(*territory).size();
  }
  const auto groups = first_groups(groups_of);
  const BodyModel model =
      make_graded_model(scene_, body_, groups.front(), approach_.focus);
  report_.tets = model.mesh.tet.rows();
  report_.unknowns = model.supports.free;
  time_own_meshes("groups of linear presses on meshes of their own", groups, count,
                  approach_.focus, false);
}

void Planner::time_good() {
  if (!approach_.graded) {
    return;
  }
  // Samples come in rounds; neighbours of a round share a mesh.
  const bool in_rounds = !approach_.cheap_is_good && !solve_all_;
  const auto groups_of = [&](const Unit& unit) {
    const std::size_t first = in_rounds ? kFirstSamples : good_of(unit);
    return group_presses(body_.surface,
                         spread_over(unit.vertex, std::max<std::size_t>(first, 1)),
                         approach_.focus, approach_.nonlinear);
  };
  double count = 0.0;
  for (const Unit* territory : territories()) {
    const auto groups = groups_of(*territory);
    std::size_t vertices = 0;
    for (const auto& group : groups) {
      vertices += group.size();
    }
    count += static_cast<double>(groups.size() * good_of(*territory)) /
             static_cast<double>(vertices);
  }
  if (count < 0.5) {
    return;
  }
  time_own_meshes(approach_.cheap_is_good
                      ? "groups of presses outside the budget, on meshes of their own"
                      : "groups of good presses on meshes of their own",
                  first_groups(groups_of), static_cast<std::size_t>(std::lround(count)),
                  approach_.focus, approach_.nonlinear);
}

void Planner::time_checks() {
  std::vector<std::vector<std::int32_t>> checks;
  for (const Unit& unit : units_) {
    if (unit.is_check) {
      checks.push_back(unit.vertex);
    }
  }
  if (checks.empty()) {
    return;
  }
  const std::size_t count = checks.size();
  checks.resize(std::min(count, workers_));
  // A linear press costs as its factor and columns do; a nonlinear one as its elements.
  const auto work = [&](const ContactFocus& focus) -> MeshWork {
    const auto& vertex = checks.front();
    const SurfaceMesh surface = graded_surface(scene_, body_, vertex, focus);
    const double reach_m = touched_radius_m(scene_, body_, 0.5 * focus.finest_m);
    return {static_cast<double>(surface.triangle.rows()),
            static_cast<double>(contact_nodes_near(surface, body_, vertex, reach_m))};
  };
  const ContactFocus fine = finer(approach_.focus, kCheckTimesFiner);
  const MeshWork here = work(approach_.focus);
  const MeshWork there = work(fine);
  const bool affordable = !approach_.nonlinear && expected_cpu_s(there) < kChecksCpuS;
  const double times = affordable ? 1.0
                       : approach_.nonlinear
                           ? there.triangles / here.triangles
                           : expected_cpu_s(there) / expected_cpu_s(here);
  time_own_meshes("checks one level finer", checks, count,
                  affordable ? fine : approach_.focus, approach_.nonlinear, times);
}

void Planner::count_responses() {
  const std::int64_t all = report_.reachable * report_.tools;
  report_.solved_at_least = all;
  report_.solved_expected = all;
  if (!approach_.cheap_is_good && !solve_all_) {
    report_.solved_at_least = 0;
    report_.solved_expected = 0;
    for (const Unit* territory : territories()) {
      report_.solved_at_least +=
          report_.tools *
          static_cast<std::int64_t>(std::min(kFirstSamples, territory->vertex.size()));
      report_.solved_expected +=
          report_.tools * static_cast<std::int64_t>(good_of(*territory));
    }
  }
  report_.interpolated_expected = all - report_.solved_expected;
}

}  // namespace

PlanReport plan(const Scene& scene, const PlanOptions& options, Progress& progress) {
  std::optional<tbb::global_control> limit;
  if (options.workers > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism,
                  static_cast<std::size_t>(options.workers));
  }
  const std::size_t workers =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  PlanReport report;
  const double seconds = seconds_of([&] {
    report = Planner(scene, options, workers, progress).run();
  });
  progress.finish();
  report.plan_seconds = seconds;
  // Every kind of work was done by all workers at once, beside what all of them share.
  report.peak_memory_bytes = std::max(report.peak_memory_bytes, peak_memory_bytes());
  return report;
}

}  // namespace palpate
