// What the live view tells its pages, as JSON: numbers of the runtime, in SI units.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "formats/recording/tick_record.h"
#include "runtime/account/local_model.h"
#include "runtime/view/view_contact.h"
#include "runtime/view/view_dents.h"
#include "runtime/view/view_friction.h"
#include "runtime/view/view_hands.h"
#include "runtime/view/view_needle.h"

namespace palpate {

/// The body as little-endian bytes. First come "PLPB", then as uint32 the number of
/// vertices n and of triangles t. Then come float32 positions [m] (3 n) and outward
/// normals (3 n). Then comes float32 stiffness at the map's depth [N/m] (n, NaN without
/// response). Then come float32 heights of the tool's reference point where it touches
/// a vertex [m] (n). Last come uint32 corners (3 t).
[[nodiscard]] std::string body_bytes(const ResponseDatabase& database,
                                     const ResponseTable& table);

/// What the page shows, and how it is rendered.
struct ViewedBody {
  const ResponseDatabase& database;
  const ResponseTable& table;
  std::string name;    ///< of the database
  std::string device;  ///< that steers in the page's place; empty: the page does
  double fast_hz = 0.0;
  double force_max_n = 0.0;
  /// Of a tool of several contacts or of two hands, one for each hand; else none.
  std::vector<const ResponseTable*> hands = {};
  /// [m] > 0 that the scene presses to, where responses are still to come; 0: they are
  /// there.
  double coming_to_m = 0.0;
};

/// What does not change: names, tool, models, ranges, colour range and colours.
[[nodiscard]] std::string body_text(const ViewedBody& body);

/// How it is rendered at the moment.
struct ViewSettings {
  LocalModel model = LocalModel::kPotential;
  double slow_hz = 0.0;
  double fast_hz = 0.0;
  std::optional<double> stiffness_scale = {};  ///< none: what the device can render
  std::optional<double> friction = {};         ///< none: the database's
};

/// What came of the run so far.
struct ViewRun {
  std::int64_t ticks = 0;
  std::int64_t late_ticks = 0;  ///< deadlines passed before them
  std::int64_t slow_updates = 0;
  std::int64_t starved_ticks = 0;
  std::int64_t extrapolated_ticks = 0;
  std::optional<double> step_p50_ns = {};  ///< none: not measured
  std::optional<double> step_p99_ns = {};
  double depth_max_m = 0.0;
  double force_max_n = 0.0;
};

/// The service that computes the body's responses meanwhile.
struct ViewService {
  std::string state;   ///< "serving", "lost", ... (served_client.h)
  std::string detail;  ///< why
  std::string stage;
  std::int64_t nodes = 0;           ///< that get an answer
  std::int64_t answered = 0;        ///< of them with one
  std::int64_t finished = 0;        ///< of them with a final one
  std::string here;                 ///< what the place under the tool answers with
  std::vector<std::int64_t> ticks;  ///< in the body, by quality (QualityTicks)
  bool changed = false;             ///< the scene's file, since it is served
};

/// A page's own device.
struct ViewDeviceShown {
  std::string_view phase = "off";  ///< "connecting", "testing", "on"
  std::string detail = {};         ///< what to do, what is felt, or why it ended
  double force_max_n = 0.0;        ///< [N]
  double hz = 0.0;                 ///< [Hz] of positions, while it is on
};

/// One frame: the state now.
struct ViewFrame {
  std::string_view state = "";  ///< "free", "pressing", "paused", ...
  bool paused = false;
  double speed = 1.0;  ///< [-] simulated time over wall time
  std::size_t clients = 0;
  bool holding = false;                        ///< a page, or its tape, holds the tool
  std::string_view tape = "empty";             ///< "recording", "recorded", "playing"
  std::optional<Eigen::Vector3d> hand_m = {};  ///< [m] of a simulated hand
  std::optional<Eigen::Vector3d> pointer_m = {};
  std::string_view fault = "none";
  double net_j = 0.0;  ///< [J] put into the local model
  TickRecord now = {};
  ViewContact contact = {};
  std::vector<NodeDent> dents = {};
  std::optional<ViewHands> hands = {};         ///< of several contacts or two hands
  std::optional<ViewNeedle> needle = {};       ///< of a tool that punctures
  std::optional<ViewFriction> friction = {};   ///< of a tool that rubs
  std::optional<ViewService> service = {};     ///< of a body that is not whole yet
  std::optional<ViewDeviceShown> device = {};  ///< of a page that can have one
  ViewRun run = {};
  ViewSettings settings = {};
};

/// A frame with every tick since the last one. Depths are the tool's, of a needle the
/// tip's.
[[nodiscard]] std::string frame_text(const ViewFrame& frame,
                                     const std::vector<TickRecord>& ticks);

/// "controller" or "watcher".
[[nodiscard]] std::string role_text(bool controls);

[[nodiscard]] std::string refusal_text(std::string_view why);

}  // namespace palpate
