// A scene whose responses come while it is rendered: simulate_served().
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/run/prepared_run.h"
#include "runtime/run/render_run.h"

namespace palpate {
namespace {

// A body that another thread's owner keeps.
class Lent : public ElementSender {
 public:
  explicit Lent(ElementSender& to) : to_(to) {}
  std::size_t update(const ToolState& tool, std::int64_t now_ns,
                     ElementFifo& fifo) override {
    return to_.update(tool, now_ns, fifo);
  }

 private:
  ElementSender& to_;
};

// The reachable vertex nearest to at_m, or the highest one.
std::int32_t vertex_to_press(const ServedScene& scene,
                             const std::optional<Eigen::Vector3d>& at_m) {
  if (scene.reachable.empty()) {
    throw InputError("the scene has no vertex that a tool reaches");
  }
  const auto score = [&](std::int32_t v) {
    const Eigen::Vector3d p = scene.plan.body.position_m.row(v).transpose();
    return at_m ? -(p - *at_m).norm() : p.z();
  };
  return *std::max_element(scene.reachable.begin(), scene.reachable.end(),
                           [&](std::int32_t a, std::int32_t b) {
                             return score(a) < score(b);
                           });
}

// @param body of the scene.
PressedBody pressed_scene(const ServedScene& scene, const ResponseDatabase& body,
                          const SimulationOptions& options) {
  check(options);
  const std::int32_t node = vertex_to_press(scene, options.at_m);
  const double depth_m = scene.plan.depth_max_m;
  const ToolShape& tool = body.tools.front().tool;
  PressedBody pressed{.tool = tool,
                      .place = pressed_place(body.body, node, node, options.at_m),
                      .stiffness = {},
                      .script =
                          [&body, &tool, node, depth_m](double, double) {
                            HandScript script;
                            script.surface_m =
                                body.body.position_m.row(node).transpose();
                            script.normal = body.normal.row(node).transpose();
                            script.touch_m = height_at_touch_m(tool, script.normal);
                            script.clear_m = std::max(0.005, depth_m);
                            script.press_m = 0.3 * depth_m;
                            script.deeper_m = 0.6 * depth_m;
                            return script;
                          },
                      .stream = nullptr};
  pressed.database = &body;
  pressed.depth_max_m = depth_m;
  pressed.open.resize(static_cast<std::size_t>(body.body.position_m.rows()), false);
  for (const std::int32_t v : scene.reachable) {
    pressed.open[static_cast<std::size_t>(v)] = true;
  }
  return pressed;
}
}  // namespace

SimulationReport simulate_served(ServedClient& client, const SimulationOptions& options,
                                 const std::atomic<bool>& stop) {
  const ServedScene& scene = client.scene(stop);
  const ResponseDatabase body = body_of(scene, client.tool());
  GrowingElements elements(body.body, body.normal, body.tools.front().tool);
  return simulate_served(client, options, stop, elements);
}

SimulationReport simulate_served(ServedClient& client, const SimulationOptions& options,
                                 const std::atomic<bool>& stop,
                                 GrowingElements& elements) {
  if (!options.real_time) {
    throw InputError(
        "a scene is rendered in real time, at which its responses come: --clock real");
  }
  const ServedScene& scene = client.scene(stop);
  const ResponseDatabase body = body_of(scene, client.tool());
  std::optional<Feeding> feeding;  // ends first
  PressedBody pressed = pressed_scene(scene, body, options);
  pressed.growing = [&](double renderable_n_per_m) {
    elements.soften_beyond(renderable_n_per_m);
    feeding.emplace(client, elements);
    return std::make_unique<Lent>(elements);
  };
  const std::vector<PreparedRun> runs = run_all(
      std::span(&options, 1), stop, [&](const SimulationOptions& one, Clock& clock) {
        return prepare(pressed, one, clock);
      });
  feeding.reset();
  SimulationReport report = runs.front().report;
  report.served = ServedReport{.status = client.status(),
                               .ticks = elements.ticks(),
                               .by_second = elements.by_second(),
                               .softened = elements.softened()};
  return report;
}
}  // namespace palpate
