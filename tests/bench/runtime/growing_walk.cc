#include "tests/bench/runtime/growing_walk.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/response/tool_support.h"
#include "runtime/bench/random_walk.h"
#include "runtime/fast/fast_step.h"
#include "runtime/served/growing_elements.h"

namespace palpate {
namespace {

NodeResponse response_of(const ResponseTable& table, std::int64_t node) {
  NodeResponse response;
  const CurveView curve = table.curve(node);
  response.direction = table.direction.row(node).transpose();
  response.touch_offset_m = table.touch_offset_m[static_cast<std::size_t>(node)];
  response.depth_m.assign(curve.depth_m.begin(), curve.depth_m.end());
  response.force_n.assign(curve.force_n.begin(), curve.force_n.end());
  response.origin = ResponseOrigin::kSimulated;
  return response;
}

// A body whose answers change at random.
class Changing {
 public:
  Changing(const ResponseDatabase& database, const ResponseTable& table,
           const GrowingWalkOptions& options)
      : database_(database),
        table_(table),
        o_(options),
        random_(options.seed + 1),
        elements_(database.body, database.normal, table.tool) {}

  [[nodiscard]] GrowingElements& elements() noexcept { return elements_; }

  bool happens(double share) { return uniform_(random_) < share; }

  // New versions for nodes around the tool. @returns how many.
  std::int64_t change_around(const Eigen::Vector3d& tool_m) {
    const SurfacePoint at = elements_.search().nearest(tool_m);
    std::array<std::int32_t, kNeighboursMax> around{};
    const std::size_t count = elements_.search().around(at.triangle, around);
    std::vector<GrownNode> answers;
    for (std::size_t i = 0; i < count; ++i) {
      const auto corner = static_cast<Eigen::Index>(random_() % 3);
      if (happens(o_.exchanges)) {
        answers.push_back(version(database_.body.triangle(around[i], corner)));
      }
    }
    const std::int64_t changed = std::ssize(answers);
    elements_.hand_over(std::move(answers));
    return changed;
  }

 private:
  GrownNode version(std::int32_t node) {
    WorkUnitNode answer{.tool = 0, .vertex = node};
    const Eigen::Vector3d n = database_.normal.row(node).transpose();
    if (!happens(o_.missing) && !table_.curve(node).depth_m.empty()) {
      answer.response = response_of(table_, node);
      const double factor = std::pow(o_.contrast, uniform_(random_));
      for (double& force_n : answer.response.force_n) {
        force_n *= factor;
      }
      answer.response.touch_offset_m += o_.shift_m * (2.0 * uniform_(random_) - 1.0);
      const Eigen::Vector3d axis = n.unitOrthogonal();
      answer.response.direction = Eigen::AngleAxisd(6.28 * uniform_(random_), n) *
                                  Eigen::AngleAxisd(o_.tilt_rad, axis) * n;
    }
    return grown_node(table_.tool, answer, GrownQuality::kFinal,
                      database_.body.position_m.row(node).transpose(), n);
  }

  const ResponseDatabase& database_;
  const ResponseTable& table_;
  GrowingWalkOptions o_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_;
  GrowingElements elements_;
};

std::unique_ptr<FastState> make_state(LocalModel model, double tool_radius_m) {
  auto state = std::make_unique<FastState>();
  state->config.model = model;
  state->config.tool_radius_m = tool_radius_m;
  state->config.force_max_n = std::numeric_limits<double>::infinity();
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return state;
}

void check_growing_walk(const GrowingWalkOptions& o) {
  const auto share = [](double value) {
    return value >= 0.0 && value <= 1.0;
  };
  if (o.ticks < 1 || o.ticks_per_slow < 1 || !(o.fast_hz > 0.0) ||
      !(o.contrast >= 1.0) || !share(o.exchanges) || !share(o.missing) ||
      !share(o.starvation) || !follows_surface(o.model)) {
    throw InputError(
        fmt::format("bench grow: {} ticks, {} per slow turn, {} Hz, contrast {}, "
                    "model {}; must be positive, contrast at least 1, shares in "
                    "[0, 1], model element or potential",
                    o.ticks, o.ticks_per_slow, o.fast_hz, o.contrast, name(o.model)));
  }
}

// The walk's account, tick by tick.
class GrowingWalk {
 public:
  GrowingWalk(const ResponseDatabase& database, const ResponseTable& table,
              const GrowingWalkOptions& options)
      : o_(options),
        body_(database.body),
        tool_(database, table, {.seed = options.seed}),
        changing_(database, table, options),
        state_(make_state(options.model, nominal_height_m(table.tool))) {}

  // @returns whether the walk goes on.
  bool tick(std::int64_t tick) {
    const double dt_s = 1.0 / o_.fast_hz;
    const Eigen::Vector3d x = tool_.step(dt_s);
    if (tick % o_.ticks_per_slow == 0 && !changing_.happens(o_.starvation)) {
      slow_turn(tick);
    }
    const std::unique_ptr<FastState> without =
        fifo_->front() != nullptr && state_->in_contact
            ? std::make_unique<FastState>(*state_)
            : nullptr;
    while (const Element* element = fifo_->front()) {
      accept(*state_, *element);
      fifo_->pop();
    }
    if (tick > 0) {
      work_j_ += static_cast<long double>(potential_j(*state_, x)) -
                 static_cast<long double>(potential_j(*state_, last_));
      report.created_j = std::max(report.created_j, static_cast<double>(-work_j_));
    }
    last_ = x;
    const FastCommand command = step(*state_, {x, 0}, dt_s);
    count(command);
    if (without != nullptr) {
      compare(*without, command, x, dt_s);
    }
    return state_->safety.fault == Fault::kNone &&
           (o_.stop == nullptr || !o_.stop->load(std::memory_order_relaxed));
  }

  void finish() {
    report.work_j = static_cast<double>(work_j_);
    report.through_j = state_->ledger.stored_j + state_->ledger.dissipated_j;
    report.interventions = state_->ledger.interventions;
    report.fault = state_->safety.fault;
  }

  GrowingWalkReport report;

 private:
  void slow_turn(std::int64_t tick) {
    report.exchanges += changing_.change_around(last_);
    const FastContact at = contact(*state_);
    const auto now_ns = std::llround(1e9 * static_cast<double>(tick) / o_.fast_hz);
    static_cast<void>(
        changing_.elements().update({.sequence = static_cast<std::uint64_t>(tick + 1),
                                     .time_ns = now_ns,
                                     .position_m = at.tool_m,
                                     .triangle = at.triangle,
                                     .in_contact = at.in_contact},
                                    now_ns, *fifo_));
  }

  void count(const FastCommand& command) {
    ++report.ticks;
    report.contact_ticks += command.in_contact ? 1 : 0;
    report.starved_ticks += command.starved ? 1 : 0;
    report.not_finite += command.force_n.allFinite() ? 0 : 1;
    report.force_max_n = std::max(report.force_max_n, command.force_n.norm());
    report.drift_j = std::max(report.drift_j, std::abs(imbalance_j(state_->ledger)));
  }

  // The same tick without what the slow turn sent.
  void compare(FastState& without, const FastCommand& with, const Eigen::Vector3d& x,
               double dt_s) {
    const FastCommand before = step(without, {x, 0}, dt_s);
    const FastContact at = contact(*state_);
    if (!before.in_contact || contact(without).triangle != at.triangle) {
      return;  // the tool is on another element, or off
    }
    double largest_n = 0.0;
    for (Eigen::Index j = 0; j < 3; ++j) {
      largest_n = std::max(
          largest_n, changing_.elements().largest_n(body_.triangle(at.triangle, j)));
    }
    const Eigen::Vector3d changed = with.force_n - before.force_n;
    report.step_max_n = std::max(report.step_max_n, changed.norm());
    ++report.compared;
    const double bound_n = GrowingElements::kStepShare * largest_n;
    if (bound_n > 0.0) {
      report.step_of_bound = std::max(report.step_of_bound, changed.norm() / bound_n);
      report.step_along_of_bound = std::max(report.step_along_of_bound,
                                            std::abs(changed.dot(at.normal)) / bound_n);
    }
  }

  GrowingWalkOptions o_;
  const SurfaceMesh& body_;
  Wanderer tool_;
  Changing changing_;
  std::unique_ptr<FastState> state_;
  std::unique_ptr<ElementFifo> fifo_ = std::make_unique<ElementFifo>();
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  long double work_j_ = 0.0L;  // a billion additions
};

}  // namespace

GrowingWalkReport run_growing_walk(const ResponseDatabase& database,
                                   const GrowingWalkOptions& options) {
  check_growing_walk(options);
  const auto begin = std::chrono::steady_clock::now();
  GrowingWalk walk(database, find_tool(database, options.tool), options);
  for (std::int64_t tick = 0; tick < options.ticks && walk.tick(tick); ++tick) {
  }
  walk.finish();
  walk.report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return walk.report;
}

GrowingWalkReport run_growing_walk(const GrowingWalkOptions& options) {
  return run_growing_walk(read_database(options.database), options);
}

std::string table_text(const GrowingWalkReport& r) {
  return fmt::format(
      "{} ticks in {:.0f} s, {} in contact, {} starved, {} curves exchanged, {} ledger "
      "interventions\n"
      "energy created at most {:.1e} J, largest drift of the account {:.1e} J, work "
      "{:.4g} J, through the account {:.4g} J\n"
      "force steps by exchanges: at most {:.4g} N, {:.3g} of the bound, along the "
      "normal "
      "{:.3g} of it ({} compared)\n"
      "largest force {:.4g} N, {} forces not finite, fault {}\n",
      r.ticks, r.seconds, r.contact_ticks, r.starved_ticks, r.exchanges,
      r.interventions, r.created_j, r.drift_j, r.work_j, r.through_j, r.step_max_n,
      r.step_of_bound, r.step_along_of_bound, r.compared, r.force_max_n, r.not_finite,
      name(r.fault));
}

std::string to_json(const GrowingWalkReport& r) {
  const nlohmann::ordered_json json{{"ticks", r.ticks},
                                    {"contact_ticks", r.contact_ticks},
                                    {"starved_ticks", r.starved_ticks},
                                    {"exchanges", r.exchanges},
                                    {"compared", r.compared},
                                    {"interventions", r.interventions},
                                    {"work_j", r.work_j},
                                    {"created_j", r.created_j},
                                    {"through_j", r.through_j},
                                    {"drift_j", r.drift_j},
                                    {"force_max_n", r.force_max_n},
                                    {"step_max_n", r.step_max_n},
                                    {"step_of_bound", r.step_of_bound},
                                    {"step_along_of_bound", r.step_along_of_bound},
                                    {"not_finite", r.not_finite},
                                    {"fault", name(r.fault)},
                                    {"seconds", r.seconds}};
  return json_text(json);
}

}  // namespace palpate
