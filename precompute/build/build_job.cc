#include "precompute/build/build_job.h"

#include <iterator>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "formats/base/sha256.h"
#include "precompute/build/program_digest.h"
#include "precompute/material/material_spectrum.h"
#include "precompute/press/needle_layers.h"
#include "precompute/press/node_yielding.h"

namespace palpate {
namespace {

// Everything that outcomes depend on; not where or by how many they are computed.
std::string digest_of(const Scene& scene, const BodySource& body,
                      const JobOptions& options) {
  Sha256 sum;
  const auto add = [&](const std::string& text) {
    sum.update(std::as_bytes(std::span(text)));
  };
  add(PALPATE_VERSION);
  add(program_digest());
  add(scene.text);
  add(options.solve_all ? "all" : "budget");
  if (options.repair != RepairMode::kOff) {
    add(fmt::format("repair {}", static_cast<int>(options.repair)));
  }
  for (const std::filesystem::path& file : body.files) {
    add(sha256_of_file(file));
  }
  return sum.hex();
}

// Where all materials relax alike, so do all responses.
Viscoelasticity uniform_relaxation(const Scene& scene, const PressStrategy& strategy) {
  const SceneSpectrum spectrum = spectrum_of(scene);
  Viscoelasticity relaxation;
  if (spectrum.uniform()) {
    relaxation.rule = strategy.nonlinear
                          ? "one spectrum for all materials: quasi-linear"
                          : "one spectrum for all materials: correspondence principle";
    relaxation.instantaneous = true;
    relaxation.tau_s = spectrum.tau_s;
    relaxation.g =
        Eigen::Map<const Eigen::RowVectorXd>(spectrum.g.data(), std::ssize(spectrum.g))
            .cast<float>();
  }
  return relaxation;
}

JobDescription description_of(const Scene& scene, const JobOptions& options,
                              const BuildJob& job) {
  const BodySource& body = job.body;
  std::vector<ToolShape> tools;
  for (const SharedTool& tool : body.tool) {
    tools.push_back(tool->shape());
  }
  return {
      .digest = digest_of(scene, body, options),
      .units = static_cast<std::int64_t>(job.units.size()),
      .body = body.surface,
      .normal = body.normal,
      .tool = std::move(tools),
      .force_relative = scene.force_relative,
      .reachable = std::ssize(job.reachable),
      .depth_max_m = scene.reach.depth_max_m,
      .force_max_n = scene.reach.force_max_n,
      .relaxation = uniform_relaxation(scene, job.strategy),
      .yielding = node_yielding(scene, body),
      .puncture = needle_layers(scene, body),
      .bundles = scene.accuracy.bundles,
      .left_out = cut_out_text(scene),
      .provenance = {.writer = fmt::format("palpate-precompute {}", PALPATE_VERSION),
                     .scene_toml = scene.text,
                     .source_file = scene.mesh.filename().string(),
                     .source_sha256 = sha256_of_file(scene.mesh),
                     .left_out = {}}};
}

}  // namespace

BuildJob build_job(const Scene& scene, const JobOptions& options) {
  BuildJob job;
  job.body = read_body(scene, options.repair);
  job.reachable = reachable_vertices(scene, job.body);
  job.strategy = choose_strategy(scene, job.body, job.reachable);
  job.units = units_of(scene, job.body, job.reachable);
  job.plan = description_of(scene, options, job);
  return job;
}

}  // namespace palpate
