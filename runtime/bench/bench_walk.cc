#include "runtime/bench/bench_walk.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/response/tool_support.h"
#include "runtime/bench/random_walk.h"
#include "runtime/fast/fast_step.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {
namespace {

constexpr double kPreslidingM = 5e-4;
constexpr double kLongTick = 10.0;

// What goes wrong between the tool and the fast process, and the slow one's turns.
class Disturbed {
 public:
  Disturbed(const ResponseDatabase& database, const ResponseTable& table,
            const WalkBenchOptions& options)
      : o_(options),
        random_(options.seed + 1),
        stream_(database, table),
        fifo_(std::make_unique<ElementFifo>()) {}

  double tick_s() { return (happens(o_.jitter) ? kLongTick : 1.0) / o_.fast_hz; }

  Eigen::Vector3d measured(Eigen::Vector3d x) {
    for (double& value : x) {
      value += o_.noise_m * normal_(random_);
      value =
          o_.quantum_m > 0.0 ? o_.quantum_m * std::round(value / o_.quantum_m) : value;
    }
    return x;
  }

  // One turn of the slow process, if it takes place.
  void slow_turn(FastState& state, std::uint64_t sequence) {
    if (happens(o_.starvation)) {
      return;
    }
    const FastContact at = contact(state);
    (void)stream_.update({.sequence = sequence,
                          .time_ns = 0,
                          .position_m = at.tool_m,
                          .triangle = at.triangle,
                          .in_contact = at.in_contact},
                         0, *fifo_);
    const double friction = o_.friction_max * uniform_(random_);
    while (const Element* sent = fifo_->front()) {
      if (!happens(o_.loss)) {
        Element element = *sent;
        for (ElementNode& node : element.node) {
          node.friction = friction;
          node.presliding_m = kPreslidingM;
        }
        accept(state, element);
      }
      fifo_->pop();
    }
  }

 private:
  bool happens(double share) { return uniform_(random_) < share; }

  WalkBenchOptions o_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_;
  std::normal_distribution<double> normal_;
  ElementStream stream_;
  std::unique_ptr<ElementFifo> fifo_;
};

std::unique_ptr<FastState> make_state(LocalModel model, double tool_radius_m) {
  auto state = std::make_unique<FastState>();
  state->config.model = model;
  state->config.tool_radius_m = tool_radius_m;
  state->config.force_max_n = std::numeric_limits<double>::infinity();
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return state;
}

void check(const WalkBenchOptions& o) {
  const auto share = [](double value) {
    return value >= 0.0 && value <= 1.0;
  };
  if (o.ticks < 1 || o.ticks_per_slow < 1 || !(o.fast_hz > 0.0) ||
      !share(o.starvation) || !share(o.loss) || !share(o.jitter)) {
    throw InputError(fmt::format(
        "bench walk: {} ticks, {} per slow turn, {} Hz, shares {}, {}, {}; must be "
        "positive, shares in [0, 1]",
        o.ticks, o.ticks_per_slow, o.fast_hz, o.starvation, o.loss, o.jitter));
  }
}

void count(WalkBenchReport& report, const FastState& state,
           const FastCommand& command) {
  ++report.ticks;
  report.contact_ticks += command.in_contact ? 1 : 0;
  report.starved_ticks += command.starved ? 1 : 0;
  report.not_finite += command.force_n.allFinite() ? 0 : 1;
  report.force_max_n = std::max(report.force_max_n, command.force_n.norm());
  report.carried_max_n =
      std::max(report.carried_max_n, static_cast<double>(command.carried_n));
  report.drift_j = std::max(report.drift_j, std::abs(imbalance_j(state.ledger)));
}

}  // namespace

WalkBenchReport run_walk(const ResponseDatabase& database,
                         const WalkBenchOptions& options) {
  check(options);
  const auto begin = std::chrono::steady_clock::now();
  const ResponseTable& table = find_tool(database, options.tool);
  Wanderer tool(database, table, {.seed = options.seed});
  Disturbed world(database, table, options);
  const auto state = make_state(options.model, nominal_height_m(table.tool));
  WalkBenchReport report;
  long double work_j = 0.0L;  // a billion additions
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (std::int64_t tick = 0; tick < options.ticks; ++tick) {
    if (tick % options.ticks_per_slow == 0) {
      world.slow_turn(*state, static_cast<std::uint64_t>(tick + 1));
    }
    const double dt_s = world.tick_s();
    const Eigen::Vector3d x = world.measured(tool.step(dt_s));
    relax_ahead(*state, dt_s);
    if (tick > 0) {
      work_j += static_cast<long double>(potential_j(*state, x)) -
                static_cast<long double>(potential_j(*state, last));
      report.created_j = std::max(report.created_j, static_cast<double>(-work_j));
    }
    last = x;
    count(report, *state, step(*state, {x, 0}, dt_s));
    if (state->safety.fault != Fault::kNone ||
        (options.stop != nullptr && options.stop->load(std::memory_order_relaxed))) {
      break;
    }
  }
  report.work_j = static_cast<double>(work_j);
  report.through_j = state->ledger.stored_j + state->ledger.dissipated_j;
  report.relaxes = state->memory.times.terms > 0;
  report.yields = state->memory.yields;
  report.yielded_j = state->ledger.yielded_j;
  report.yielded_sites = state->memory.yielded.count;
  report.shortened = state->memory.shortened;
  report.forgotten = state->memory.forgotten;
  report.interventions = state->ledger.interventions;
  report.fault = state->safety.fault;
  report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

WalkBenchReport run_walk_bench(const WalkBenchOptions& options) {
  return run_walk(read_database(options.database), options);
}

std::string table_text(const WalkBenchReport& r) {
  std::string text = fmt::format(
      "{} ticks in {:.0f} s, {} in contact, {} starved, {} ledger interventions\n"
      "energy created at most {:.1e} J, largest drift of the account {:.1e} J, work "
      "{:.4g} J, through the account {:.4g} J\n"
      "largest force {:.4g} N, {} forces not finite, fault {}\n",
      r.ticks, r.seconds, r.contact_ticks, r.starved_ticks, r.interventions,
      r.created_j, r.drift_j, r.work_j, r.through_j, r.force_max_n, r.not_finite,
      name(r.fault));
  if (r.relaxes) {
    text += fmt::format(
        "relaxed at most {:.4g} N; {} steps of relaxing shortened, {} dents "
        "forgotten\n",
        r.carried_max_n, r.shortened, r.forgotten);
  }
  if (r.yields) {
    text += fmt::format("{} sites have yielded, {:.4g} J dissipated by it\n",
                        r.yielded_sites, r.yielded_j);
  }
  return text;
}

std::string to_json(const WalkBenchReport& r) {
  nlohmann::ordered_json json{{"ticks", r.ticks},
                              {"contact_ticks", r.contact_ticks},
                              {"starved_ticks", r.starved_ticks},
                              {"interventions", r.interventions},
                              {"work_j", r.work_j},
                              {"created_j", r.created_j},
                              {"drift_j", r.drift_j},
                              {"through_j", r.through_j},
                              {"force_max_n", r.force_max_n},
                              {"relaxes", r.relaxes},
                              {"carried_max_n", r.carried_max_n},
                              {"shortened", r.shortened},
                              {"forgotten", r.forgotten},
                              {"yields", r.yields},
                              {"yielded_j", r.yielded_j},
                              {"yielded_sites", r.yielded_sites},
                              {"not_finite", r.not_finite},
                              {"fault", name(r.fault)},
                              {"seconds", r.seconds}};
  return json_text(json);
}

}  // namespace palpate
