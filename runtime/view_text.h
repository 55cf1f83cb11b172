// What the live view tells its pages, as JSON: numbers of the runtime, in SI units.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/view_session.h"

namespace palpate {

/// The body as little-endian bytes: "PLPB", then as uint32 the number of vertices n and
/// of triangles t; float32 positions [m] (3 n), outward normals (3 n), stiffness at the
/// map's depth [N/m] (n, NaN without response); uint32 corners (3 t).
[[nodiscard]] std::string body_bytes(const ResponseDatabase& database,
                                     const ResponseTable& table);

/// What does not change: names, tool, models, ranges, colour range and colours.
[[nodiscard]] std::string body_text(const ViewSession& session,
                                    const std::string& database_name);

/// What the view adds to the session's state.
struct ViewMoment {
  std::string_view state;  ///< "free", "pressing", "paused", ...
  bool paused = false;
  double speed = 0.0;  ///< [-] simulated time over wall time
  std::size_t clients = 0;
};

/// One frame: the state now, and every tick since the last frame.
[[nodiscard]] std::string frame_text(const ViewSession& session,
                                     const ViewMoment& moment,
                                     const std::vector<TickRecord>& ticks);

/// The curve of a node. @throws InputError for a node that is not there.
[[nodiscard]] std::string curve_text(const ViewSession& session, std::int32_t node);

/// "controller" or "watcher".
[[nodiscard]] std::string role_text(bool controls);

[[nodiscard]] std::string refusal_text(std::string_view why);

}  // namespace palpate
