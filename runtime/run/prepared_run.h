// A run before its first tick: PressedBody, the body, tool and place that it presses,
// and PreparedRun, the device, elements and recorders that render it. For the sources
// of this folder alone; render_run.h is the interface.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "runtime/render/recorder.h"
#include "runtime/render/render_loop.h"
#include "runtime/render/several_contacts.h"
#include "runtime/run/render_run.h"
#include "runtime/slow/response_source.h"

namespace palpate {

/// @throws InputError for options out of range.
void check(const SimulationOptions& options);

using MakeScript = std::function<HandScript(double force_scale, double hand_n_per_m)>;

/// Of several contacts, what one contact does not have.
struct PressedTogether {
  MakeScript second_script;  // of the second hand; null: there is one
  PressedPlace second_place = {};
  double table_error = 0.0;
  bool convex = true;
  double turning_n_m_per_rad = 0.0;
};

/// Where a hand presses, and how.
struct PlaceToPress {
  PressedPlace place;
  MakeScript script;  ///< needs the source
};

/// The node to press nearest to `at_m` [m] (node_to_press(), streamed_place()).
[[nodiscard]] PlaceToPress place_on(const ResponseSource& source,
                                    const std::string& tool,
                                    const std::optional<Eigen::Vector3d>& at_m,
                                    double force_max_n);

/// What a run presses, wherever its responses lie.
struct PressedBody {
  ToolShape tool;
  PressedPlace place;
  RenderedStiffness stiffness;
  int contacts = 1;
  std::vector<std::string> tables = {};  // of responses; none: the tool's own
  // Of tools of several contacts, instead of the stream.
  std::function<std::unique_ptr<RenderedBody>(const FastConfig& config,
                                              const ContactsHeld& held,
                                              const Eigen::Vector3d& start_m)>
      several = nullptr;
  std::optional<PressedTogether> together = {};  // likewise
  MakeScript script;
  std::function<std::unique_ptr<ElementSender>(double force_scale,
                                               const Eigen::Vector3d& start_m)>
      stream;
  // Of a body whose responses are still to come, instead of the stream.
  std::function<std::unique_ptr<ElementSender>(double renderable_n_per_m)> growing =
      nullptr;
  // Where a hand may wander; null: not in memory.
  const ResponseDatabase* database = nullptr;
  std::vector<bool> open = {};
  double depth_max_m = 0.0;
};

/// A run of one tool, ready to be rendered.
struct PreparedRun {
  RenderConfig config;
  SimulationReport report;
  std::unique_ptr<Device> device;
  std::unique_ptr<Device> second;  // of a second hand
  std::vector<RenderTick> trace;
  std::unique_ptr<ElementSender> sender;
  std::unique_ptr<RenderedBody> several;  // instead of a sender
  RecordingHeader header;
  std::unique_ptr<Recorder> recorder;
  std::unique_ptr<FlightLog> flight;
};

/// Prepares the run of one tool. @param clock of all tools.
using PrepareOne =
    std::function<PreparedRun(const SimulationOptions& options, Clock& clock)>;

/// Checks the margin, and makes device, elements and records.
[[nodiscard]] PreparedRun prepare(const PressedBody& body,
                                  const SimulationOptions& options, Clock& clock);

/// Prepares a run for each tool, and renders all of them at once.
[[nodiscard]] std::vector<PreparedRun> run_all(std::span<const SimulationOptions> tools,
                                               const std::atomic<bool>& stop,
                                               const PrepareOne& prepare_one);

}  // namespace palpate
