#include "tests/bench/runtime/bench_held.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <random>
#include <string_view>

#include <Eigen/Core>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/response/tool_support.h"
#include "runtime/fast/fast_step.h"
#include "runtime/slow/field_stiffness.h"
#include "runtime/slow/memory_elements.h"
#include "tests/bench/runtime/edge_crossing.h"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double kHeldTickS = 0.001;
constexpr int kTicksPerUpdate = 10;
constexpr int kDownTicks = 50;
constexpr double kAboveM = 0.001;

constexpr std::array<std::string_view, 3> kWayNames{"across", "normal", "anywhere"};

std::string_view name(HeldWay way) {
  return kWayNames[static_cast<std::size_t>(way)];
}

// One tool over one body, from the slow process to the force.
class HeldRun {
 public:
  HeldRun(const ResponseDatabase& database, const ResponseTable& table)
      : stream_(database, table),
        radius_m_(nominal_height_m(table.tool)),
        fifo_(std::make_unique<ElementFifo>()),
        state_(std::make_unique<FastState>()) {}

  [[nodiscard]] double radius_m() const { return radius_m_; }

  void begin(LocalModel model, const Vector3d& x) {
    *state_ = {};
    state_->config = {.model = model,
                      .tool_radius_m = radius_m_,
                      .force_max_n = std::numeric_limits<double>::infinity(),
                      .slew_max_n_per_s = std::numeric_limits<double>::infinity(),
                      .energy_floor_j = std::numeric_limits<double>::infinity()};
    ticks_ = 0;
    x_ = x;
    (void)move(x);
  }

  // @returns what the hand gets in this tick beyond the potential [J].
  double move(const Vector3d& x) {
    if (ticks_ % kTicksPerUpdate == 0) {
      const FastContact at = contact(*state_);
      (void)stream_.update({.sequence = static_cast<std::uint64_t>(ticks_ + 1),
                            .time_ns = 0,
                            .position_m = x_,
                            .triangle = at.triangle,
                            .in_contact = at.in_contact},
                           0, *fifo_);
    }
    ++ticks_;
    relax_ahead(*state_, kHeldTickS);
    const double excess_j =
        force_n_.dot(x - x_) + potential_j(*state_, x) - potential_j(*state_, x_);
    for (; fifo_->front() != nullptr; fifo_->pop()) {
      accept(*state_, *fifo_->front());
    }
    const FastCommand command = step(
        *state_, {x, static_cast<std::int64_t>(1e9 * kHeldTickS) * ticks_}, kHeldTickS);
    force_n_ = command.force_n;
    touches_ = command.in_contact && command.fault == 0;
    x_ = x;
    return excess_j;
  }

  [[nodiscard]] bool touches() const { return touches_; }

 private:
  ElementStream stream_;
  double radius_m_;
  std::unique_ptr<ElementFifo> fifo_;
  std::unique_ptr<FastState> state_;
  std::int64_t ticks_ = 0;
  Vector3d x_ = Vector3d::Zero();
  Vector3d force_n_ = Vector3d::Zero();
  bool touches_ = false;
};

// Places that are a step apart.
class HeldPath {
 public:
  HeldPath(HeldWay way, const EdgeCrossing& at, const Vector3d& middle_m, double step_m)
      : way_(way), at_(at), middle_m_(middle_m), step_m_(step_m) {}

  [[nodiscard]] Vector3d next() {
    side_ = -side_;
    if (way_ != HeldWay::kAnywhere) {
      return middle_m_ + 0.5 * side_ * step_m_ *
                             (way_ == HeldWay::kAcross ? at_.across : at_.normal);
    }
    // Back towards the middle when it is far.
    std::normal_distribution<double> any;
    const Vector3d way =
        Vector3d(any(random_), any(random_), any(random_)) - 0.3 * away_m_ / step_m_;
    away_m_ += step_m_ * way.normalized();
    return middle_m_ + away_m_;
  }

 private:
  HeldWay way_;
  EdgeCrossing at_;
  Vector3d middle_m_;
  double step_m_;
  double side_ = 1.0;
  Vector3d away_m_ = Vector3d::Zero();
  std::mt19937_64 random_{1};
};

// Over all edges.
struct HeldSum {
  HeldBenchRow row;
  double sum = 0.0;

  void add(HeldRun& run, HeldPath path, int ticks, double k_n_per_m) {
    const double bound_j = 0.5 * k_n_per_m * row.step_m * row.step_m;
    (void)run.move(path.next());
    double given_j = 0.0;
    double tick_j = 0.0;
    for (int tick = 0; tick < ticks; ++tick) {
      const double excess_j = run.move(path.next());
      given_j += excess_j;
      tick_j = std::max(tick_j, excess_j);
    }
    const double given = given_j / (ticks * bound_j);
    row.given = std::max(row.given, given);
    row.tick = std::max(row.tick, tick_j / bound_j);
    sum += given;
    ++row.edges;
    row.given_mean = sum / row.edges;
  }
};

}  // namespace

std::vector<HeldBenchRow> run_held_bench(const ResponseDatabase& database,
                                         const ResponseTable& table,
                                         const HeldBenchOptions& options) {
  if (!(options.depth_share > 0.0 && options.depth_share <= 1.0) || options.ticks < 2 ||
      options.edges < 1) {
    throw InputError("bench held: a depth share in (0, 1], ticks from 2, edges from 1");
  }
  const double depth_m = options.depth_share * table.depth_max_m();
  const std::vector<EdgeCrossing> crossings = edge_crossings(database, table);
  const std::size_t every =
      1 + crossings.size() / static_cast<std::size_t>(options.edges);
  HeldRun run(database, table);
  std::vector<HeldBenchRow> rows;
  for (const LocalModel model : kLocalModels) {
    if (!passive(model)) {
      continue;
    }
    const double k_n_per_m =
        model_stiffness(database, table, model, std::numeric_limits<double>::infinity())
            .largest_n_per_m();
    for (const HeldWay way : {HeldWay::kAcross, HeldWay::kNormal, HeldWay::kAnywhere}) {
      for (const double step_m : {1e-6, 1e-5, 1e-4}) {
        HeldSum sum{
            {.model = model, .way = way, .step_m = step_m, .k_n_per_m = k_n_per_m}};
        for (std::size_t i = 0; i < crossings.size(); i += every) {
          const EdgeCrossing& at = crossings[i];
          const auto over = [&](double height_m) -> Vector3d {
            return at.middle_m + (run.radius_m() + height_m) * at.normal;
          };
          run.begin(model, over(kAboveM));
          for (int tick = 1; tick <= kDownTicks; ++tick) {
            (void)run.move(over(kAboveM - (kAboveM + depth_m) * tick / kDownTicks));
          }
          if (run.touches()) {
            sum.add(run, HeldPath(way, at, over(-depth_m), step_m), options.ticks,
                    k_n_per_m);
          }
        }
        rows.push_back(sum.row);
      }
    }
  }
  return rows;
}

std::string table_text(const std::vector<HeldBenchRow>& rows) {
  std::string text =
      fmt::format("{:<13} {:<9} {:>7} {:>6} {:>8} {:>10} {:>10} {:>10}\n", "model",
                  "way", "dx um", "edges", "K N/m", "given mean", "most", "of a tick");
  for (const HeldBenchRow& row : rows) {
    text += fmt::format(
        "{:<13} {:<9} {:>7.0f} {:>6} {:>8.4g} {:>10.4f} {:>10.4f} {:>10.4f}\n",
        name(row.model), name(row.way), 1e6 * row.step_m, row.edges, row.k_n_per_m,
        row.given_mean, row.given, row.tick);
  }
  return text;
}

std::string to_json(const std::vector<HeldBenchRow>& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const HeldBenchRow& row : rows) {
    json.push_back({{"model", name(row.model)},
                    {"way", name(row.way)},
                    {"step_m", row.step_m},
                    {"edges", row.edges},
                    {"k_n_per_m", row.k_n_per_m},
                    {"given_mean", row.given_mean},
                    {"given_most", row.given},
                    {"given_tick", row.tick}});
  }
  return json_text(nlohmann::ordered_json{{"rows", json}});
}

}  // namespace palpate
