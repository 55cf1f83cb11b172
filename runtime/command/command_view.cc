// palpate-run view: see and feel a database in a browser, with the mouse.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/recording/surface_state.h"
#include "formats/report/page_assets.h"
#include "runtime/bench/cylinder_body.h"
#include "runtime/command/commands.h"
#include "runtime/command/coupling_options.h"
#include "runtime/command/device_options.h"
#include "runtime/command/scene_options.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/stop_signals.h"
#include "runtime/run/render_run.h"
#include "runtime/run/run_outcome.h"
#include "runtime/view/live_view.h"
#include "runtime/view/served_news.h"
#include "runtime/view/view_json.h"
#include "runtime/view/view_policy.h"
#include "runtime/view/view_server.h"
#include "runtime/view/view_session.h"
#include "runtime/view/watch_view.h"

namespace palpate {
namespace {

struct ViewFlags {
  std::string database;
  std::string demo;
  std::string model = "potential";
  std::uint16_t port = 0;
  double stiffness_scale = 1.0;
  double seconds = 3600.0;  // of a device's run
  bool limit_stiffness = false;
  bool fast_hz_given = false;
  SurfaceFiles surface;
  ViewSessionOptions options;
  DeviceFlags device;
  CouplingFlags coupling;
  SceneFlags scene;
};

ResponseDatabase shown(const ViewFlags& flags) {
  if (flags.demo.empty() == flags.database.empty()) {
    throw InputError("give a database or --demo cylinder, one of the two");
  }
  if (flags.demo.empty()) {
    return read_database(flags.database);
  }
  if (flags.demo != "cylinder") {
    throw InputError(
        fmt::format("--demo {}: unknown body; known: cylinder", flags.demo));
  }
  return cylinder_body({});
}

std::string shown_name(const ViewFlags& flags) {
  return flags.demo.empty() ? std::filesystem::path(flags.database).filename().string()
                            : flags.demo;
}

ViewServerOptions server_options(const ViewFlags& flags, const ViewedBody& body) {
  ViewServerOptions options;
  options.port = flags.port;
  options.token = random_token();
  options.assets.assign(page_assets().begin(), page_assets().end());
  options.data = {
      {"/body.json", "application/json", body_text(body)},
      {"/body.bin", "application/octet-stream", body_bytes(body.database, body.table)}};
  return options;
}

void say_where(const ViewServer& server) {
  fmt::print("{}\n", server.address());
  std::fflush(stdout);  // who reads a pipe waits for it
  fmt::print(stderr, "open this address in a browser on this machine; Ctrl-C ends\n");
}

void check_stiffness_scale(double scale) {
  if (!(scale >= ViewRanges::kStiffnessMin && scale <= ViewRanges::kStiffnessMax)) {
    throw InputError(fmt::format("--stiffness-scale {}: must lie in [{}, {}]", scale,
                                 ViewRanges::kStiffnessMin, ViewRanges::kStiffnessMax));
  }
}

// @throws InputError for files of a body that has none itself.
SurfaceState begin(const ViewFlags& flags) {
  const bool any = !flags.surface.in.empty() || !flags.surface.out.empty();
  if (any && flags.database.empty()) {
    throw InputError("--surface-in and --surface-out need a database file");
  }
  return begin_surface(flags.surface, flags.database);
}

// The page is served until somebody ends it.
void serve(const ViewFlags& flags, const ViewedBody& body, ViewSession& session,
           ServedNews* news = nullptr) {
  MonotonicClock wall;
  LiveView live(session, wall, news);
  ViewServer server(server_options(flags, body), live);
  live.answer_through(server);
  const std::atomic<bool>& stop = stop_signals();
  say_where(server);
  server.run(stop);
}

// The page steers, on simulated time.
void steer(const ViewFlags& flags, const ResponseDatabase& database) {
  check_stiffness_scale(flags.stiffness_scale);
  ViewSessionOptions options = flags.options;
  options.tools = flags.device.tools;
  options.model = requested_model(flags.model);
  SurfaceState surface = begin(flags);
  const std::vector<std::string> tables = surface_tables(database, flags.device.tools);
  options.surface = surface_of(surface, tables);
  ViewSession session(database, options);
  session.set({.stiffness_scale = flags.stiffness_scale});
  serve(flags, viewed(session, shown_name(flags)), session);
  if (!flags.surface.out.empty()) {
    put_surface(session.kept(), tables, surface);
    write_surface_state(flags.surface.out, surface);
  }
}

SimulationOptions watched_options(ViewFlags& flags, TickQueue& ticks) {
  SimulationOptions options;
  options.model = requested_model(flags.model);
  options.duration_s = flags.seconds;
  constexpr double kDeviceHz = 1000.0;
  options.fast_hz = flags.fast_hz_given ? flags.options.fast_hz : kDeviceHz;
  options.slow_hz = flags.options.slow_hz;
  options.force_max_n = flags.options.force_max_n;
  options.limit_stiffness = flags.limit_stiffness;
  options.coupling = wanted_coupling(flags.coupling);
  options.watch = &ticks;
  options.surface = begin(flags);
  attach_device(flags.device, options);
  return options;
}

// Renders in a thread of its own, while the pages watch until it is over.
SimulationReport look_on(const ViewFlags& flags, const ViewedBody& body,
                         WatchView& view,
                         const std::function<SimulationReport()>& render) {
  ViewServer server(server_options(flags, body), view);
  view.answer_through(server);
  std::atomic<bool> over = false;
  std::future<SimulationReport> run = std::async(std::launch::async, [&] {
    const auto end = [](std::atomic<bool>* flag) {
      flag->store(true);
    };
    const std::unique_ptr<std::atomic<bool>, decltype(end)> at_end(&over, end);
    return render();
  });
  // Refusals come before the device is opened: there is nothing to look at then.
  if (run.wait_for(std::chrono::milliseconds(200)) == std::future_status::timeout) {
    say_where(server);
  }
  try {
    server.run(over);
  } catch (...) {
    request_stop();  // the device's run ends; else its future would wait for it here
    throw;
  }
  SimulationReport report = run.get();
  fmt::print("{}", summary(report));
  return report;
}

// A device steers, in real time.
void watch(ViewFlags& flags, const ResponseDatabase& database) {
  const std::atomic<bool>& stop = stop_signals();
  const auto ticks = std::make_unique<TickQueue>();
  const auto contacts = std::make_unique<ContactsWatch>();
  SimulationOptions options = watched_options(flags, *ticks);
  ViewedBody body{.database = database,
                  .table = find_tool(database, options.tool),
                  .name = shown_name(flags),
                  .device = flags.device.request.name,
                  .fast_hz = options.fast_hz,
                  .force_max_n = options.force_max_n};
  const bool several = flags.device.together || !body.table.tool.contact.empty();
  if (several) {
    options.watch_contacts = contacts.get();
    body.hands = find_tools(database, flags.device.tools);
  }
  const auto needle = std::make_unique<NeedleWatch>();
  options.watch_needle = needle.get();
  const auto friction = std::make_unique<FrictionWatch>();
  options.watch_friction = shows_friction(body.table) ? friction.get() : nullptr;
  WatchView view(body, options, *ticks);
  const SimulationReport report = look_on(flags, body, view, [&] {
    return simulate(database, options, stop);
  });
  leave_surface(flags.surface, options.surface, std::span(&report, 1));
  throw_what_ended(report);
}

// Of a scene, what pages see before any response has come.
ViewedBody viewed_scene(const ServedScene& scene, ViewedBody body) {
  body.coming_to_m = scene.plan.depth_max_m;
  return body;
}

// A scene, while it is computed: the page steers, on simulated time that follows the
// clock.
void steer_scene(const ViewFlags& flags) {
  const std::atomic<bool>& stop = stop_signals();
  const auto client =
      join_scene(flags.database, flags.scene,
                 flags.device.tools.empty() ? "" : flags.device.tools.front());
  const ServedScene& scene = client->scene(stop);
  const ResponseDatabase body = body_of(scene, client->tool());
  GrowingElements elements(body.body, body.normal, body.tools.front().tool);
  const Feeding feeding(*client, elements);
  ViewSessionOptions options = flags.options;
  options.model = requested_model(flags.model);
  options.growing = &elements;
  ViewSession session(body, options);
  check_stiffness_scale(flags.stiffness_scale);
  session.set({.stiffness_scale = flags.stiffness_scale});
  const ViewedBody shown_body = viewed_scene(scene, viewed(session, shown_name(flags)));
  ServedNews news(*client, elements, scene, SceneWatch(flags.database));
  serve(flags, shown_body, session, &news);
}

// The same while a device steers, in real time; the pages watch.
void watch_scene(ViewFlags& flags) {
  const std::atomic<bool>& stop = stop_signals();
  const auto ticks = std::make_unique<TickQueue>();
  const auto friction = std::make_unique<FrictionWatch>();
  SimulationOptions options = watched_options(flags, *ticks);
  const auto client =
      join_scene(flags.database, flags.scene,
                 flags.device.tools.empty() ? "" : flags.device.tools.front());
  const ServedScene& scene = client->scene(stop);
  const ResponseDatabase database = body_of(scene, client->tool());
  GrowingElements elements(database.body, database.normal, database.tools.front().tool);
  options.watch_friction =
      shows_friction(database.tools.front()) ? friction.get() : nullptr;
  const ViewedBody body = viewed_scene(scene, {.database = database,
                                               .table = database.tools.front(),
                                               .name = shown_name(flags),
                                               .device = flags.device.request.name,
                                               .fast_hz = options.fast_hz,
                                               .force_max_n = options.force_max_n});
  ServedNews news(*client, elements, scene, SceneWatch(flags.database));
  WatchView view(body, options, *ticks, &news);
  throw_what_ended(look_on(flags, body, view, [&] {
    return simulate_served(*client, options, stop, elements);
  }));
}

void show_scene(ViewFlags& flags) {
  refuse_surface(flags.surface);
  refuse_together_of_scene(flags.device);
  if (!flags.demo.empty()) {
    throw InputError("a scene is shown by itself: leave out --demo");
  }
  if (flags.device.request.name.empty()) {
    steer_scene(flags);
  } else {
    watch_scene(flags);
  }
}

void show(ViewFlags& flags) {
  if (is_scene(flags.database)) {
    show_scene(flags);
    return;
  }
  refuse_scene_options(flags.scene);
  const ResponseDatabase database = shown(flags);
  check_tools(flags.device);
  if (flags.device.request.name.empty() && wanted_coupling(flags.coupling)) {
    throw InputError("--coupling: is of a device's run; give --device");
  }
  if (!flags.device.request.name.empty()) {
    watch(flags, database);
  } else {
    steer(flags, database);
  }
}

}  // namespace

void add_view_command(Command app) {
  Command command = app.add_subcommand(
      "view",
      "Show a database in a browser: press it with the mouse, on simulated time, or "
      "watch a device that presses it.");
  const auto flags = std::make_shared<ViewFlags>();
  ViewSessionOptions& options = flags->options;
  command.add_option(
      "database", flags->database,
      "Response database (HDF5 or flat), or a scene (SCENE.toml) that is "
      "computed while it is shown");
  add_scene_options(command, flags->scene);
  command.add_option("--demo", flags->demo,
                     "A body without a file: cylinder, the paper's (section 5.2.4)");
  command.add_option("--port", flags->port, "On 127.0.0.1; 0: any free one")
      .show_default();
  command.add_option("--model", flags->model, "Local model: " + known_models())
      .show_default();
  add_tool_options(command, flags->device);
  command.add_option("--slow-hz", options.slow_hz, "Rate of element updates [Hz]")
      .show_default();
  command.add_option("--fast-hz", options.fast_hz, "Rate of force updates [Hz]")
      .show_default();
  command.add_option("--force-max-n", options.force_max_n, "Largest force [N]")
      .show_default();
  command
      .add_option("--stiffness-scale", flags->stiffness_scale,
                  "Forces are multiplied by it, at the start")
      .show_default();
  add_surface_options(command, flags->surface);
  add_device_options(command, flags->device);
  add_coupling_options(command, flags->coupling);
  command.add_option("--seconds", flags->seconds, "Duration of a device's run [s]")
      .show_default();
  command.add_flag("--limit-stiffness", flags->limit_stiffness,
                   "Scale forces to what the device can render");
  command.callback([flags, command] {
    flags->fast_hz_given = command.count("--fast-hz") > 0;
    show(*flags);
  });
}

}  // namespace palpate
