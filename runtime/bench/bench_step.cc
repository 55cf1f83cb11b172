#include "runtime/bench/bench_step.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/base/quantile.h"
#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"

namespace palpate {
namespace {

using SteadyClock = std::chrono::steady_clock;

double elapsed_ns(SteadyClock::time_point from) {
  return std::chrono::duration<double, std::nano>(SteadyClock::now() - from).count();
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return quantile(values, share);
}

double clock_cost_ns() {
  std::vector<double> empty(10001);
  for (double& value : empty) {
    value = elapsed_ns(SteadyClock::now());
  }
  return percentile(empty, 0.5);
}

constexpr double kToolRadiusM = 0.005;

// What the tool moves over, and how deep it may come.
struct Scene {
  const char* name;
  BenchBodyOptions body;
  double depth_m = 0.008;  // lowest point of the tool; negative: above the surface
  int tools = 1;           // each with a state of its own, on the same walk
  bool needle = false;     // the tool punctures; of models that are a field
};

// From everything at once down to nothing to feel.
std::vector<Scene> scenes() {
  const BenchBodyOptions organ{
      .wave_m = 0.004, .contrast = 9.0, .tilt_rad = 0.2, .friction_max = 1.0};
  BenchBodyOptions smooth = organ;
  smooth.friction_max = 0.0;
  BenchBodyOptions relaxing = organ;
  relaxing.relaxing = {0.258, 0.303};
  relaxing.relaxation_s = {0.42, 4.5};
  BenchBodyOptions bundles = relaxing;
  bundles.bundles = 8;
  BenchBodyOptions dents = organ;
  dents.yielding = NodeYielding{.yield_depth_m = 0.001, .share = 0.4};
  BenchBodyOptions softening = dents;
  softening.yielding->onset_m = 0.001;
  softening.yielding->scale_m = 0.002;
  softening.yielding->largest = 0.5;
  const BenchBodyOptions rigid{.exponent = 1.0, .force_n = 100.0, .samples = 2};
  return {{.name = "two tools", .body = organ, .tools = 2},
          {.name = "friction", .body = organ},
          {.name = "smooth", .body = smooth},
          {.name = "relaxing", .body = relaxing},
          {.name = "8 bundles", .body = bundles},
          {.name = "dents", .body = dents},
          {.name = "softening", .body = softening},
          {.name = "needle", .body = smooth, .needle = true},
          {.name = "rigid wall", .body = rigid, .depth_m = 0.001},
          {.name = "free space", .body = smooth, .depth_m = -0.004}};
}

// One channel takes up the whole walk: a tip finds it again wherever it comes down.
PunctureRules bench_needle() {
  PunctureRules rules;
  rules.materials = 2;
  rules.material[0] = {0.3, 0.1, 5.0, 1.2};
  rules.material[1] = {0.2, 0.15, 8.0, 1.2};
  rules.shaft_n_per_m = 100.0;
  rules.lateral_n_per_m2 = 5000.0;
  rules.mouth_m = 1.0;
  return rules;
}

NodePuncture bench_layers() {
  NodePuncture below;
  below.layers = 2;
  below.rupture = 0.3;
  below.depth_m[1] = 0.002;
  below.material[1] = 1;
  return below;
}

// The walk and the messages that the slow process would send along it.
struct StepRecording {
  std::vector<Eigen::Vector3d> position_m;
  std::vector<std::vector<Element>> messages;  // one entry per slow tick
};

StepRecording record(const StepBenchOptions& options, const Scene& scene) {
  BenchBody body = make_bench_body(scene.body);
  for (Element& element : body.element) {
    element.puncture.fill(scene.needle ? bench_layers() : NodePuncture{});
  }
  StepRecording recording;
  recording.position_m =
      make_bench_walk(body, {.ticks = options.ticks,
                             .tool_radius_m = kToolRadiusM,
                             .depth_m = scene.depth_m,
                             .lift_m = std::max(0.002, 0.002 - scene.depth_m)});
  for (int tick = 0; tick < options.ticks; tick += options.ticks_per_slow) {
    recording.messages.push_back(
        body.around(recording.position_m[static_cast<std::size_t>(tick)]));
  }
  return recording;
}

std::vector<std::unique_ptr<FastState>> make_states(LocalModel model,
                                                    const Scene& scene) {
  std::vector<std::unique_ptr<FastState>> states;
  for (int i = 0; i < scene.tools; ++i) {
    states.push_back(std::make_unique<FastState>());
    states.back()->config.model = model;
    states.back()->config.tool_radius_m = kToolRadiusM;
    if (scene.needle && is_field(model)) {
      states.back()->config.puncture = bench_needle();
    }
  }
  return states;
}

StepBenchRow run(const StepRecording& recording, LocalModel model, const Scene& scene,
                 int ticks_per_slow, std::uint64_t (*allocations)()) {
  const auto states = make_states(model, scene);
  std::vector<double> step_ns;
  std::vector<double> accept_ns;
  step_ns.reserve(recording.position_m.size());
  accept_ns.reserve(recording.position_m.size() * states.size());
  // Two readings of the clock cost clock_ns, which is taken off every time.
  const double clock_ns = clock_cost_ns();
  const std::uint64_t before = allocations();
  const auto every = static_cast<std::size_t>(ticks_per_slow);
  for (std::size_t tick = 0; tick < recording.position_m.size(); ++tick) {
    if (tick % every == 0) {
      for (const Element& element : recording.messages[tick / every]) {
        for (const auto& state : states) {
          const auto from = SteadyClock::now();
          accept(*state, element);
          accept_ns.push_back(elapsed_ns(from) - clock_ns);
        }
      }
    }
    // A tick of 0.5 ms: 2 kHz.
    const FastSample sample{recording.position_m[tick], 0};
    const auto from = SteadyClock::now();
    for (const auto& state : states) {
      (void)step(*state, sample, 0.0005);
    }
    step_ns.push_back(elapsed_ns(from) - clock_ns);
  }
  StepBenchRow row;
  row.model = model;
  row.scene = scene.name;
  row.allocations = allocations() - before;
  row.median_ns = percentile(step_ns, 0.5);
  row.p999_ns = percentile(step_ns, 0.999);
  row.accept_median_ns = percentile(accept_ns, 0.5);
  return row;
}

}  // namespace

std::vector<StepBenchRow> run_step_bench(const StepBenchOptions& options,
                                         std::uint64_t (*allocations)()) {
  std::vector<StepBenchRow> rows;
  for (const Scene& scene : scenes()) {
    const StepRecording recording = record(options, scene);
    for (const LocalModel model : kLocalModels) {
      rows.push_back(run(recording, model, scene, options.ticks_per_slow, allocations));
    }
  }
  return rows;
}

std::string table_text(const std::vector<StepBenchRow>& rows) {
  std::string text =
      fmt::format("{:<10} {:<16} {:>10} {:>10} {:>16} {:>12}\n", "scene", "model",
                  "median ns", "99.9 % ns", "accept median ns", "allocations");
  for (const StepBenchRow& row : rows) {
    text += fmt::format("{:<10} {:<16} {:>10.0f} {:>10.0f} {:>16.0f} {:>12}\n",
                        row.scene, name(row.model), row.median_ns, row.p999_ns,
                        row.accept_median_ns, row.allocations);
  }
  return text;
}

std::string to_json(const std::vector<StepBenchRow>& rows) {
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  for (const StepBenchRow& row : rows) {
    json["rows"].push_back({{"scene", row.scene},
                            {"model", name(row.model)},
                            {"median_ns", row.median_ns},
                            {"p999_ns", row.p999_ns},
                            {"accept_median_ns", row.accept_median_ns},
                            {"allocations", row.allocations}});
  }
  return json_text(json);
}

}  // namespace palpate
