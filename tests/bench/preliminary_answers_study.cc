// How far preliminary answers of a service are from its final ones, and what they cost.
//   preliminary_answers_study SCENE.toml [GROUPS, default 40]
// So many groups of the scene's nodes, spread over the body, are answered preliminarily
// and pressed well (linear scenes). Prints for each way CPU seconds a node, and for
// preliminary ones the difference of force, and the share of nodes where it is within
// what is stated.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>

#include <fmt/format.h>

#include "formats/base/quantile.h"
#include "formats/database/place_check.h"
#include "formats/response/force_difference.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/serve/preliminary_answers.h"

namespace palpate {
namespace {

double cpu_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// The groups at equal distances in their order, which is that of the surface.
std::vector<PreliminaryGroup> spread(const std::vector<PreliminaryGroup>& groups,
                                     std::size_t count) {
  std::vector<PreliminaryGroup> some;
  for (std::size_t i = 0; i < std::min(count, groups.size()); ++i) {
    some.push_back(groups[i * groups.size() / std::min(count, groups.size())]);
  }
  return some;
}

void study(const Scene& scene, std::size_t count) {
  const BuildJob job = build_job(scene, {});
  const SharedTool& tool = job.body.tool.front();
  double preliminary_s = 0.0;
  double full_s = 0.0;
  std::vector<double> found;
  std::vector<double> stated;
  std::int64_t within = 0;
  std::int64_t nodes = 0;
  for (const PreliminaryGroup& group : spread(preliminary_groups(scene, job), count)) {
    nodes += std::ssize(group);
    double began = cpu_s();
    std::map<std::int32_t, NodeResponse> preliminary;
    for (const WorkUnitNode& node : preliminary_answers(scene, job, group)) {
      if (node.tool == 0 && !node.response.depth_m.empty()) {
        preliminary[node.vertex] = node.response;
      }
    }
    preliminary_s += cpu_s() - began;
    began = cpu_s();
    const auto full =
        press_on_own_mesh(scene, job.body, tool, group, job.strategy.focus, {});
    full_s += cpu_s() - began;
    for (const PressedNode& node : full) {
      const WorkUnitNode answer = answer_of(scene, job, tool, node);
      if (answer.response.depth_m.empty() || !preliminary.contains(node.vertex)) {
        continue;
      }
      const NodeResponse& rough = preliminary.at(node.vertex);
      found.push_back(response_difference(
          rough, answer.response, job.body.normal.row(node.vertex).transpose()));
      stated.push_back(rough.error_relative);
      within += found.back() <= stated.back() ? 1 : 0;
    }
  }
  std::sort(found.begin(), found.end());
  std::sort(stated.begin(), stated.end());
  fmt::print(
      "nodes {}: preliminary {:.3f} s, full {:.3f} s a node; off by {:.1f} % in the "
      "median, "
      "{:.1f} % at the 95th percentile; stated {:.1f} % in the median, holds at {:.3f} "
      "of {}\n",
      nodes, preliminary_s / static_cast<double>(nodes),
      full_s / static_cast<double>(nodes), 100 * quantile(found, 0.5),
      100 * quantile(found, 0.95), 100 * quantile(stated, 0.5),
      static_cast<double>(within) / static_cast<double>(found.size()), found.size());
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: preliminary_answers_study SCENE.toml [GROUPS]\n");
    return 2;
  }
  palpate::study(palpate::read_scene(argv[1]),
                 argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 40);
  return 0;
}
