#include "runtime/run/render_run.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/hand/press_site.h"
#include "runtime/run/prepared_run.h"
#include "runtime/run/several_run.h"
#include "runtime/slow/field_stiffness.h"
#include "runtime/slow/file_press_site.h"

namespace palpate {
namespace {

std::vector<SimulationReport> reports(const std::vector<PreparedRun>& runs) {
  std::vector<SimulationReport> all;
  for (const PreparedRun& run : runs) {
    all.push_back(run.report);
  }
  return all;
}

// Of one contact.
RenderedStiffness stiffness_of_run(const ResponseDatabase& database,
                                   const ResponseTable& table,
                                   const SimulationOptions& options) {
  if (options.stiffness || options.together || !table.tool.contact.empty()) {
    return options.stiffness.value_or(RenderedStiffness{});
  }
  return model_stiffness(database, table, options.model, options.force_max_n);
}

// @param loss of the curves that had to be thinned.
PressedBody pressed_body(const ResponseDatabase& database,
                         const SimulationOptions& options, ResampleLoss& loss) {
  const ResponseTable& table = find_tool(database, options.tool);
  check(options);
  const std::int32_t node = node_to_press(database, table, options.at_m);
  const double force_max_n = options.force_max_n;
  PressedBody body{
      .tool = table.tool,
      .node = node,
      .stiffness = stiffness_of_run(database, table, options),
      .script =
          [&database, &table, node, force_max_n](double scale, double hand_n_per_m) {
            return script_at(database, table, node, force_max_n, scale, hand_n_per_m);
          },
      .stream = [&database, &table, &loss](double scale, const Eigen::Vector3d&)
          -> std::unique_ptr<ElementSender> {
        auto stream = std::make_unique<ElementStream>(database, table, scale);
        loss = stream->resample_loss();
        return stream;
      }};
  body.database = &database;
  body.depth_max_m = table.depth_max_m();
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    body.open.push_back(!table.curve(i).depth_m.empty());
  }
  return table.tool.contact.empty() && !options.together
             ? body
             : pressed_by_several(database, table, std::move(body), options);
}
}  // namespace

std::string known_models() {
  std::string names;
  for (const LocalModel model : kLocalModels) {
    names += (names.empty() ? "" : ", ") + std::string(name(model));
  }
  return names;
}

LocalModel requested_model(const std::string& model) {
  const auto known = local_model(model);
  if (!known) {
    throw InputError(fmt::format("--model {}: unknown local model; known: {}", model,
                                 known_models()));
  }
  return *known;
}

double hold_s(LocalModel model, double fast_hz, double slow_hz, double wire_s) {
  const bool slow =
      model == LocalModel::kSingle || model == LocalModel::kFirstOrderHold;
  return std::max(1.0 / (slow ? slow_hz : fast_hz), wire_s);
}

SimulationReport simulate(const ResponseDatabase& database,
                          const SimulationOptions& options,
                          const std::atomic<bool>& stop) {
  return simulate(database, std::span(&options, 1), stop).front();
}

std::vector<SimulationReport> simulate(const ResponseDatabase& database,
                                       std::span<const SimulationOptions> tools,
                                       const std::atomic<bool>& stop) {
  const auto prepare_one = [&](const SimulationOptions& options, Clock& clock) {
    ResampleLoss loss;
    PreparedRun run = prepare(pressed_body(database, options, loss), options, clock);
    run.report.resample_loss = loss;
    return run;
  };
  return reports(run_all(tools, stop, prepare_one));
}
std::vector<SimulationReport> simulate_streamed(
    const std::filesystem::path& file, std::span<const SimulationOptions> tools,
    std::size_t budget_bytes, const std::atomic<bool>& stop) {
  const ChunkReader reader(file);
  const auto prepare_one = [&](const SimulationOptions& options, Clock& clock) {
    const std::size_t tool = find_tool(reader.index(), options.tool);
    check(options);
    const StreamedPlace place = streamed_place(reader, tool, options.at_m);
    const PressedBody body{
        .tool = reader.index().tools[tool].tool,
        .node = place.source_node,
        .stiffness = streamed_stiffness(reader, tool, options.force_max_n),
        .script =
            [&](double scale, double hand_n_per_m) {
              return script_at(place.around, place.around.tools[0], place.row,
                               options.force_max_n, scale, hand_n_per_m);
            },
        .stream = [&](double scale, const Eigen::Vector3d& start_m)
            -> std::unique_ptr<ElementSender> {
          const CacheOptions cache{.tool = options.tool,
                                   .budget_bytes = budget_bytes / tools.size(),
                                   .force_scale = scale};
          return std::make_unique<StreamedElements>(file, cache, start_m,
                                                    options.real_time);
        }};
    return prepare(body, options, clock);
  };
  std::vector<PreparedRun> runs = run_all(tools, stop, prepare_one);
  for (PreparedRun& run : runs) {
    auto& streamed = dynamic_cast<StreamedElements&>(*run.sender);
    streamed.stop();
    run.report.stream = streamed.report();
    run.report.resample_loss = run.report.stream->cache.loss;
  }
  return reports(runs);
}

}  // namespace palpate
