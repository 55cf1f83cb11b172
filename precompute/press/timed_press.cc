#include "precompute/press/timed_press.h"

#include <algorithm>

#include "precompute/press/compliance_sample.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/process/interrupt.h"
#include "precompute/process/peak_memory.h"

namespace palpate {
namespace {

// Processor seconds since the last call, or since it was made.
class Stopwatch {
 public:
  double lap_s() {
    const double now = cpu_seconds();
    const double lap = now - last_s_;
    last_s_ = now;
    return lap;
  }

 private:
  double last_s_ = cpu_seconds();
};

std::vector<PricedPresses> one_for_each(std::span<const int> depths) {
  std::vector<PricedPresses> presses;
  for (const int d : depths) {
    presses.push_back({.depths = d, .node = {}, .price = {}});
  }
  return presses;
}

void press(const Scene& scene, const BodyModel& model,
           const SurfaceCompliance& compliance, const SharedTool& tool, PressMode mode,
           std::span<PressedNode> nodes, int depths) {
  for (PressedNode& node : nodes) {
    node.path.samples = depths;
  }
  mode.options = nonlinear_options(scene, tool);
  press_placed(model, compliance, nodes, mode);
}

}  // namespace

std::vector<PricedPresses> press_on_shared_mesh(
    const Scene& scene, const BodySource& body, const PressStrategy& strategy,
    std::span<const std::int32_t> reachable, std::span<const std::int32_t> vertices,
    std::span<const int> depths, bool nonlinear) {
  const SharedTool& tool = body.tool.front();
  restart_peak_memory();
  Stopwatch watch;
  const BodyModel model = make_body_model(scene, body, strategy.surface);
  std::vector<PressedNode> placed;
  for (const std::int32_t v : reachable) {
    placed.push_back(placed_node(scene, body, model, tool, v));
  }
  const ColumnSample sample = column_sample(model, placed, vertices);
  check_interrupted();
  (void)compliance_of(model, placed, std::vector<char>(sample.wanted.size(), 0),
                      nullptr);
  const double once_s = watch.lap_s();
  const SurfaceCompliance compliance =
      compliance_of(model, placed, sample.wanted, nullptr);
  const double columns_s = watch.lap_s();
  // Columns are shared by neighbours: their number grows with the body, not with nodes.
  const double all_columns_s =
      columns_s * static_cast<double>(sample.all) /
      static_cast<double>(std::max<std::size_t>(sample.solved, 1));
  std::vector<PressedNode> chosen;
  for (PressedNode& node : placed) {
    if (std::binary_search(vertices.begin(), vertices.end(), node.vertex)) {
      chosen.push_back(std::move(node));
    }
  }
  std::vector<PricedPresses> presses = one_for_each(depths);
  for (PricedPresses& some : presses) {
    check_interrupted();
    some.node = chosen;
    watch.lap_s();
    press(scene, model, compliance, tool, {.nonlinear = nonlinear}, some.node,
          some.depths);
    some.price = {once_s + all_columns_s, 0.0,
                  watch.lap_s() / static_cast<double>(chosen.size()),
                  peak_memory_bytes()};
  }
  return presses;
}

std::vector<PricedPresses> press_on_own_meshes(const Scene& scene,
                                               const BodySource& body,
                                               const ContactFocus& focus,
                                               std::span<const std::int32_t> vertices,
                                               std::span<const int> depths,
                                               PressMode mode) {
  const SharedTool& tool = body.tool.front();
  const auto groups = group_presses(body.surface, vertices, focus, mode.nonlinear);
  std::vector<PricedPresses> presses = one_for_each(depths);
  restart_peak_memory();
  for (const std::vector<std::int32_t>& group : groups) {
    check_interrupted();
    Stopwatch watch;
    const BodyModel model = make_graded_model(scene, body, group, focus);
    const double group_s = watch.lap_s();
    std::vector<PressedNode> placed;
    placed.reserve(group.size());
    for (const std::int32_t v : group) {
      placed.push_back(placed_node(scene, body, model, tool, v));
    }
    const SurfaceCompliance compliance = compliance_among(model, placed);
    const double compliance_s = watch.lap_s();
    for (PricedPresses& some : presses) {
      std::vector<PressedNode> nodes = placed;
      watch.lap_s();
      press(scene, model, compliance, tool, mode, nodes, some.depths);
      // Means: of a model by groups, of compliance and presses by nodes [s].
      some.price.per_group_s += group_s / static_cast<double>(groups.size());
      some.price.per_node_s +=
          (compliance_s + watch.lap_s()) / static_cast<double>(vertices.size());
      some.price.peak_memory_bytes = peak_memory_bytes();
      some.node.insert(some.node.end(), nodes.begin(), nodes.end());
    }
  }
  for (PricedPresses& some : presses) {
    std::sort(some.node.begin(), some.node.end(),
              [](const PressedNode& a, const PressedNode& b) {
                return a.vertex < b.vertex;
              });
  }
  return presses;
}

}  // namespace palpate
