#include "runtime/slow/file_elements.h"

#include <chrono>
#include <exception>
#include <string>

#include "runtime/realtime/clock.h"

namespace palpate {

StreamedElements::StreamedElements(const std::filesystem::path& file,
                                   const CacheOptions& options,
                                   const Eigen::Vector3d& start_m, bool in_thread)
    : cache_(file, options) {
  motion_.position_m = start_m;
  load_all(motion_);
  if (in_thread) {
    thread_ = std::thread([this] {
      run();
    });
  }
}

StreamedElements::~StreamedElements() {
  stop();
}

void StreamedElements::stop() {
  stop_.store(true);
  if (thread_.joinable()) {
    thread_.join();
  }
}

// The loading thread. Errors of chunks end in the cache; it looks again after a
// millisecond, a tenth of a slow period. Any other exception ends the hand-out of
// elements, and with it the force.
void StreamedElements::run() noexcept {
  try {
    while (!stop_.load()) {
      if (wish_.fetch()) {
        cache_.follow(wish_.latest());
      }
      if (!cache_.step()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  } catch (const std::exception& error) {
    cache_.give_up(error.what());
  }
}

void StreamedElements::load_all(const ToolMotion& motion) {
  cache_.follow(motion);
  while (cache_.step()) {
    static_cast<void>(cache_.take());
  }
}

void StreamedElements::follow(const ToolState& tool) {
  const double dt_s =
      static_cast<double>(tool.time_ns - time_ns_) / kNanosecondsPerSecond;
  if (updates_ > 1 && dt_s > 0.0) {
    motion_.velocity_m_per_s = (tool.position_m - motion_.position_m) / dt_s;
  }
  motion_.position_m = tool.position_m;
  time_ns_ = tool.time_ns;
  if (thread_.joinable()) {
    wish_.write(motion_);
  } else if (!stop_.load()) {
    load_all(motion_);
  }
}

std::int32_t StreamedElements::active_row(const SurfacePiece& piece,
                                          const ToolState& tool, std::int32_t in_use) {
  SurfacePoint point;
  if (in_use >= 0) {
    point = piece.search().walk(tool.position_m, in_use);
  } else {
    point = piece.search().nearest(tool.position_m);
    if (!(point.distance_m < piece.missing_distance_m(tool.position_m))) {
      return -1;
    }
  }
  return point.triangle >= 0 && piece.is_surrounded(point.triangle) ? point.triangle
                                                                    : -1;
}

std::size_t StreamedElements::update(const ToolState& tool, std::int64_t now_ns,
                                     ElementFifo& fifo) {
  if (!tool.position_m.allFinite()) {
    return 0;
  }
  ++updates_;
  if (cache_.has_given_up()) {
    ++starved_;
    return 0;
  }
  follow(tool);
  const SurfacePiece* piece = cache_.take();
  const bool walk = tool.in_contact && tool.triangle >= 0 &&
                    tool.triangle < cache_.index().triangles();
  const std::int32_t in_use =
      piece != nullptr && walk ? piece->row_of(tool.triangle) : -1;
  const std::int32_t active = piece == nullptr ? -1 : active_row(*piece, tool, in_use);
  if (active < 0) {
    ++starved_;
    return 0;
  }
  bool complete = !walk || (in_use >= 0 && piece->is_surrounded(in_use));
  const WantedTriangles wanted = wanted_triangles(piece->search(), active, in_use);
  std::size_t sent = 0;
  for (std::size_t i = 0; i < wanted.count; ++i) {
    if (!piece->is_surrounded(wanted.triangle[i])) {
      complete = false;
      continue;
    }
    Element message = piece->element(wanted.triangle[i]);
    message.sequence = ++sequence_;
    message.sent_ns = now_ns;
    message.active = i == 0;
    sent += fifo.push(message) ? 1 : 0;
  }
  starved_ += complete ? 0 : 1;
  return sent;
}

StreamReport StreamedElements::report() const {
  return {.cache = cache_.counts(),
          .updates = updates_,
          .starved = starved_,
          .fault = cache_.is_damaged() ? cache_.damage() : ""};
}

}  // namespace palpate
