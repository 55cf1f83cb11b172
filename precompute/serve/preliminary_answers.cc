#include "precompute/serve/preliminary_answers.h"

#include <algorithm>

#include "formats/base/error.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/process/failure_of.h"

namespace palpate {
namespace {

constexpr PressMode kPreliminaryMode{
    .recipe = {.times_finer = 1.0 / kPreliminaryTimesCoarser}};

}  // namespace

std::vector<PreliminaryGroup> preliminary_groups(const Scene& scene,
                                                 const BuildJob& job) {
  if (scene.cutout) {
    return {};
  }
  return group_presses(job.body.surface, job.reachable,
                       finer(job.strategy.focus, kPreliminaryMode.recipe.times_finer),
                       false);
}

WorkUnitNode answer_of(const Scene& scene, const BuildJob& job, const SharedTool& tool,
                       const PressedNode& node) {
  const auto which = std::find(job.body.tool.begin(), job.body.tool.end(), tool);
  WorkUnitNode answer{
      .tool = static_cast<std::int32_t>(which - job.body.tool.begin()),
      .vertex = node.vertex,
      .response = to_response(node.indentation, node.path, scene.force_relative),
      .failure = node.failure};
  fail_if_broken(answer);
  return answer;
}

std::vector<WorkUnitNode> preliminary_answers(const Scene& scene, const BuildJob& job,
                                              std::span<const std::int32_t> vertices) {
  std::vector<WorkUnitNode> answers;
  for (const SharedTool& tool : job.body.tool) {
    try {
      (void)failure_of("a linear press", [&] {
        for (const PressedNode& node :
             press_on_own_mesh(scene, job.body, tool, vertices, job.strategy.focus,
                               kPreliminaryMode)) {
          answers.push_back(answer_of(scene, job, tool, node));
          double& error = answers.back().response.error_relative;
          error = job.strategy.nonlinear ? 1.0 : kPreliminaryErrorFactor * error;
        }
      });
    } catch (const ResourceError&) {
      // Good answers wait for what is wanting.
    }
  }
  return answers;
}

}  // namespace palpate
