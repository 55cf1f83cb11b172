#include "tests/bench/runtime/bench_slide.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/fast/fast_step.h"
#include "runtime/realtime/step_histogram.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr double kBodyRadiusM = 0.05;
constexpr double kStiffnessNPerM = 1000.0;
constexpr double kDepthMaxM = 0.006;
constexpr double kSlideTickS = 0.0005;
constexpr double kStepM = 0.1 * kSlideTickS;  // 0.1 m/s
constexpr int kTicksPerSlow = 20;
constexpr double kClearM = 0.002;

std::int64_t elapsed_ns(SteadyClock::time_point from) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(SteadyClock::now() - from)
      .count();
}

// m meridians and m parallels, poles on the z axis: 2 m^2 triangles.
SurfaceMesh sphere_mesh(std::int64_t triangles) {
  const auto m = static_cast<std::int32_t>(
      std::ceil(std::sqrt(static_cast<double>(triangles) / 2.0)));
  SurfaceMesh mesh;
  mesh.position_m.resize(Eigen::Index{m} * m + 2, 3);
  for (std::int32_t i = 0; i < m; ++i) {
    const double polar = std::numbers::pi * (i + 1) / (m + 1);
    for (std::int32_t j = 0; j < m; ++j) {
      const double around = 2.0 * std::numbers::pi * j / m;
      mesh.position_m.row(Eigen::Index{i} * m + j)
          << std::sin(polar) * std::cos(around),
          std::sin(polar) * std::sin(around), std::cos(polar);
    }
  }
  const std::int32_t north = m * m;
  const std::int32_t south = north + 1;
  mesh.position_m.row(north) << 0.0, 0.0, 1.0;
  mesh.position_m.row(south) << 0.0, 0.0, -1.0;
  mesh.position_m *= kBodyRadiusM;
  mesh.triangle.resize(2 * Eigen::Index{m} * m, 3);
  Eigen::Index t = 0;
  for (std::int32_t j = 0; j < m; ++j) {
    const std::int32_t k = (j + 1) % m;
    mesh.triangle.row(t++) << north, j, k;
    mesh.triangle.row(t++) << south, (m - 1) * m + k, (m - 1) * m + j;
    for (std::int32_t i = 0; i + 1 < m; ++i) {
      const std::int32_t row = i * m;
      mesh.triangle.row(t++) << row + j, row + m + j, row + m + k;
      mesh.triangle.row(t++) << row + j, row + m + k, row + k;
    }
  }
  return mesh;
}

// A place of a path: along a great circle that leans from the mesh's lines.
struct Stop {
  double along_m = 0.0;
  double depth_m = 0.0;
};

std::vector<Stop> path_of(bool slide, int rounds) {
  const double depth_m = slide ? 0.001 : 0.004;
  const double length_m = slide ? 0.06 : 0.01;
  std::vector<Stop> path{{0.0, -kClearM}};
  for (int i = 0; i < rounds; ++i) {
    path.insert(path.end(),
                {{0.0, depth_m}, {length_m, depth_m}, {0.0, depth_m}, {0.0, -kClearM}});
  }
  return path;
}

Eigen::Vector3d outward(double along_m) {
  const Eigen::Vector3d e1 = Eigen::Vector3d(1.0, 0.3, 0.1).normalized();
  const Eigen::Vector3d e2 =
      (Eigen::Vector3d(-0.2, 1.0, 0.6) - Eigen::Vector3d(-0.2, 1.0, 0.6).dot(e1) * e1)
          .normalized();
  const double angle = along_m / kBodyRadiusM;
  return std::cos(angle) * e1 + std::sin(angle) * e2;
}

class SlideRun {
 public:
  SlideRun(const ResponseDatabase& database, LocalModel model)
      : radius_m_(database.tools[0].tool.radius_m),
        stream_(database, database.tools[0]),
        fifo_(std::make_unique<ElementFifo>()),
        state_(std::make_unique<FastState>()) {
    state_->config.model = model;
    state_->config.tool_radius_m = radius_m_;
    state_->config.force_max_n = std::numeric_limits<double>::infinity();
    state_->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  }

  SlideBenchRow run(const std::vector<Stop>& path) {
    tick(path.front(), false);
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Stop& from = path[i - 1];
      const Stop& to = path[i];
      const double length_m =
          std::hypot(to.along_m - from.along_m, to.depth_m - from.depth_m);
      const int steps = static_cast<int>(std::ceil(length_m / kStepM));
      const bool level = from.depth_m == to.depth_m;
      for (int s = 1; s <= steps; ++s) {
        const double t = static_cast<double>(s) / steps;
        tick({(1.0 - t) * from.along_m + t * to.along_m,
              (1.0 - t) * from.depth_m + t * to.depth_m},
             level);
      }
    }
    return finish();
  }

 private:
  void tick(const Stop& at, bool level) {
    const Eigen::Vector3d n = outward(at.along_m);
    const Eigen::Vector3d x = (kBodyRadiusM + radius_m_ - at.depth_m) * n;
    if (ticks_ % kTicksPerSlow == 0) {
      slow_turn();
    }
    if (ticks_ > 0) {
      work_j_ += potential_j(*state_, x) - potential_j(*state_, x_);
    }
    const auto from = SteadyClock::now();
    while (const Element* element = fifo_->front()) {
      accept(*state_, *element);
      fifo_->pop();
    }
    const FastCommand command = step(*state_, {x, 0}, kSlideTickS);
    step_time_.add(elapsed_ns(from));
    felt_j_ -= ticks_ > 0 ? 0.5 * (force_n_ + command.force_n).dot(x - x_) : 0.0;
    x_ = x;
    force_n_ = command.force_n;
    ++ticks_;
    account(at, n, command, level);
  }

  void slow_turn() {
    const FastContact at = contact(*state_);
    const Eigen::Vector3d x =
        ticks_ == 0 ? Eigen::Vector3d(2.0 * kBodyRadiusM * outward(0.0)) : at.tool_m;
    const auto from = SteadyClock::now();
    (void)stream_.update({.sequence = static_cast<std::uint64_t>(ticks_ + 1),
                          .time_ns = 0,
                          .position_m = x,
                          .triangle = at.triangle,
                          .in_contact = at.in_contact},
                         0, *fifo_);
    slow_time_.add(elapsed_ns(from));
  }

  void account(const Stop& at, const Eigen::Vector3d& n, const FastCommand& command,
               bool level) {
    row_.created_j = std::max(row_.created_j, -work_j_);
    row_.felt_j = std::max(row_.felt_j, -felt_j_);
    row_.stored_j = std::max(row_.stored_j, command.stored_j);
    row_.not_finite += command.force_n.allFinite() ? 0 : 1;
    if (level) {
      const double normal_n = command.force_n.dot(n);
      const double wanted_n = kStiffnessNPerM * at.depth_m;
      level_n_.push_back(normal_n);
      error_square_ += std::pow(normal_n / wanted_n - 1.0, 2.0);
    }
  }

  SlideBenchRow finish() {
    row_.tool_radius_m = radius_m_;
    row_.p50_ns = step_time_.percentile_ns(0.5);
    row_.p999_ns = step_time_.percentile_ns(0.999);
    row_.slow_ns = slow_time_.percentile_ns(0.5);
    row_.net_j = work_j_;
    row_.interventions = state_->ledger.interventions;
    const auto middle =
        level_n_.begin() + static_cast<std::ptrdiff_t>(level_n_.size() / 2);
    std::nth_element(level_n_.begin(), middle, level_n_.end());
    row_.force_n = *middle;
    row_.error = std::sqrt(error_square_ / static_cast<double>(level_n_.size()));
    return row_;
  }

  double radius_m_;
  ElementStream stream_;
  std::unique_ptr<ElementFifo> fifo_;
  std::unique_ptr<FastState> state_;
  StepHistogram step_time_;
  StepHistogram slow_time_;
  SlideBenchRow row_;
  std::vector<double> level_n_;
  double error_square_ = 0.0;
  double work_j_ = 0.0;
  double felt_j_ = 0.0;
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
  std::int64_t ticks_ = 0;
};

}  // namespace

ResponseDatabase slide_body(std::int64_t triangles, double tool_radius_m,
                            double friction) {
  if (triangles < 18 || triangles > 10'000'000) {
    throw InputError(
        fmt::format("bench slide: {} triangles, must be 18 to 10000000", triangles));
  }
  ResponseDatabase database;
  database.body = sphere_mesh(triangles);
  database.normal = vertex_normals(database.body);
  std::vector<NodeResponse> responses;
  for (Eigen::Index i = 0; i < database.body.position_m.rows(); ++i) {
    NodeResponse response;
    response.direction = database.normal.row(i).transpose();
    response.origin = ResponseOrigin::kSimulated;
    response.depth_m = {0.0, 0.5 * kDepthMaxM, kDepthMaxM};
    response.force_n = {0.0, 0.5 * kStiffnessNPerM * kDepthMaxM,
                        kStiffnessNPerM * kDepthMaxM};
    responses.push_back(response);
  }
  const ToolShape tool{.name = "ball",
                       .radius_m = tool_radius_m,
                       .friction = friction,
                       .presliding_m = 5e-4};
  database.tools = {make_table(tool, responses)};
  return database;
}

std::vector<SlideBenchRow> run_slide_bench(const SlideBenchOptions& options) {
  if (options.rounds < 1 || !follows_surface(options.model)) {
    throw InputError(fmt::format(
        "bench slide: {} rounds of model {}, must be positive and of a model that "
        "follows the surface: element, potential",
        options.rounds, name(options.model)));
  }
  std::vector<SlideBenchRow> rows;
  for (const std::int64_t triangles : options.triangles) {
    for (const double radius_m : options.tool_radius_m) {
      for (const double friction : options.friction) {
        const ResponseDatabase database = slide_body(triangles, radius_m, friction);
        for (const bool slide : {true, false}) {
          SlideRun run(database, options.model);
          rows.push_back(run.run(path_of(slide, options.rounds)));
          rows.back().triangles = database.body.triangle.rows();
          rows.back().friction = friction;
          rows.back().path = slide ? "slide" : "cycle";
        }
      }
    }
  }
  return rows;
}

std::string table_text(const std::vector<SlideBenchRow>& rows) {
  std::string text = fmt::format(
      "{:>9} {:>7} {:>4} {:<6} {:>8} {:>9} {:>9} {:>9} {:>10} {:>9} {:>9} {:>8} {:>8} "
      "{:>7}\n",
      "triangles", "tool mm", "mu", "path", "p50 ns", "p99.9 ns", "slow us",
      "stored mJ", "created mJ", "felt mJ", "lost mJ", "force N", "error %", "ledger");
  for (const SlideBenchRow& r : rows) {
    text += fmt::format(
        "{:>9} {:>7.3g} {:>4.2g} {:<6} {:>8.0f} {:>9.0f} {:>9.1f} {:>9.3g} {:>10.1e} "
        "{:>9.1e} {:>9.2e} {:>8.4g} {:>8.2g} {:>7}\n",
        r.triangles, r.tool_radius_m * 1e3, r.friction, r.path, r.p50_ns, r.p999_ns,
        r.slow_ns * 1e-3, r.stored_j * 1e3, r.created_j * 1e3, r.felt_j * 1e3,
        r.net_j * 1e3, r.force_n, r.error * 100.0, r.interventions);
  }
  return text;
}

std::string to_json(const std::vector<SlideBenchRow>& rows) {
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  for (const SlideBenchRow& r : rows) {
    json["rows"].push_back({{"triangles", r.triangles},
                            {"tool_radius_m", r.tool_radius_m},
                            {"friction", r.friction},
                            {"path", r.path},
                            {"p50_ns", r.p50_ns},
                            {"p999_ns", r.p999_ns},
                            {"slow_ns", r.slow_ns},
                            {"stored_j", r.stored_j},
                            {"created_j", r.created_j},
                            {"felt_j", r.felt_j},
                            {"net_j", r.net_j},
                            {"force_n", r.force_n},
                            {"rms_relative_error", r.error},
                            {"interventions", r.interventions},
                            {"not_finite", r.not_finite}});
  }
  return json_text(json);
}

}  // namespace palpate
