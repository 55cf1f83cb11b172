#include "runtime/run/render_run.h"

#include <algorithm>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/hand/press_site.h"
#include "runtime/run/prepared_run.h"
#include "runtime/run/several_run.h"
#include "runtime/slow/file_elements.h"
#include "runtime/slow/file_press_site.h"

namespace palpate {
namespace {

// @param handed_out gets the tables that the run is fed by.
PressedBody pressed_body(const ResponseSource& source, const SimulationOptions& options,
                         std::vector<TableElements*>& handed_out) {
  check(options);
  const ToolShape& tool = source.tool(options.tool).shape;
  PlaceToPress place = place_on(source, tool.name, options.at_m, options.force_max_n);
  PressedBody pressed{
      .tool = tool,
      .place = place.place,
      .stiffness = {},
      .script = std::move(place.script),
      .stream = [&source, &tool, &handed_out](
                    double scale,
                    const Eigen::Vector3d& start_m) -> std::unique_ptr<ElementSender> {
        auto elements = source.elements(tool.name, scale, start_m);
        handed_out.push_back(elements.get());
        return elements;
      }};
  if (const ResponseDatabase* database = source.database()) {
    const ResponseTable& table = find_tool(*database, tool.name);
    pressed.database = database;
    pressed.depth_max_m = table.depth_max_m();
    for (std::int64_t i = 0; i < table.nodes(); ++i) {
      pressed.open.push_back(!table.curve(i).depth_m.empty());
    }
  }
  if (!tool.contact.empty() || options.together) {
    return pressed_by_several(source, std::move(pressed), options, handed_out);
  }
  pressed.stiffness = options.stiffness ? *options.stiffness
                                        : source.stiffness(tool.name, options.model,
                                                           options.force_max_n);
  return pressed;
}

// What came of the tables that fed a run.
void note_tables(std::span<TableElements* const> tables, SimulationReport& report) {
  for (TableElements* table : tables) {
    if (auto* streamed = dynamic_cast<StreamedElements*>(table)) {
      streamed->stop();
      report.stream.emplace(report.stream.value_or(StreamReport{}))
          .add(streamed->report());
    }
    report.resample_loss.add(table->resample_loss());
  }
}

std::vector<SimulationReport> simulate_on(const ResponseSource& source,
                                          std::span<const SimulationOptions> tools,
                                          const std::atomic<bool>& stop) {
  std::deque<std::vector<TableElements*>> handed_out;
  const auto prepare_one = [&](const SimulationOptions& options, Clock& clock) {
    return prepare(pressed_body(source, options, handed_out.emplace_back()), options,
                   clock);
  };
  std::vector<PreparedRun> runs = run_all(tools, stop, prepare_one);
  std::vector<SimulationReport> all;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    note_tables(handed_out[i], runs[i].report);
    all.push_back(runs[i].report);
  }
  return all;
}

}  // namespace

PlaceToPress place_on(const ResponseSource& source, const std::string& tool,
                      const std::optional<Eigen::Vector3d>& at_m, double force_max_n) {
  if (const ResponseDatabase* database = source.database()) {
    const ResponseTable& table = find_tool(*database, tool);
    const std::int32_t node = node_to_press(*database, table, at_m);
    return {pressed_place(database->body, node, node, at_m),
            [=, &table](double scale, double hand_n_per_m) {
              return script_at(*database, table, node, force_max_n, scale,
                               hand_n_per_m);
            }};
  }
  const ChunkReader& reader = *source.reader();
  const auto place = std::make_shared<const StreamedPlace>(
      streamed_place(reader, find_tool(reader.index(), tool), at_m));
  return {pressed_place(place->around.body, place->row, place->source_node, at_m),
          [=](double scale, double hand_n_per_m) {
            return script_at(place->around, place->around.tools[0], place->row,
                             force_max_n, scale, hand_n_per_m);
          }};
}

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
  return simulate_on(*responses_in_memory(database), tools, stop);
}

std::vector<SimulationReport> simulate_streamed(
    const std::filesystem::path& file, std::span<const SimulationOptions> tools,
    std::size_t budget_bytes, const std::atomic<bool>& stop) {
  const std::size_t share = budget_bytes / std::max<std::size_t>(1, tools.size());
  const bool in_thread = !tools.empty() && tools.front().real_time;
  return simulate_on(*responses_in_file(file, share, in_thread), tools, stop);
}

}  // namespace palpate
