#include "runtime/slow/file_elements.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <string>

#include "runtime/realtime/clock.h"

namespace palpate {

StreamedElements::StreamedElements(const StoredSource& file,
                                   const CacheOptions& options,
                                   const Eigen::Vector3d& start_m, bool in_thread)
    : cache_(file, options) {
  motions_.contact[0].position_m = start_m;
  motions_.count = 1;
  load_all();
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
        cache_.follow(wish_.latest().all());
      }
      if (!cache_.step()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  } catch (const std::exception& error) {
    cache_.give_up(error.what());
  }
}

void StreamedElements::load_all() {
  cache_.follow(motions_.all());
  while (cache_.step()) {
    static_cast<void>(cache_.take());
  }
}

void StreamedElements::follow(std::span<const ToolState> contacts) {
  piece_ = nullptr;
  if (contacts.empty() || cache_.has_given_up()) {
    return;
  }
  const std::int64_t now_ns = contacts.front().time_ns;
  const double dt_s = static_cast<double>(now_ns - time_ns_) / kNanosecondsPerSecond;
  const bool moved = ++followed_ > 1 && contacts.size() == motions_.count && dt_s > 0.0;
  motions_.count = std::min(contacts.size(), motions_.contact.size());
  for (std::size_t i = 0; i < motions_.count; ++i) {
    ToolMotion& motion = motions_.contact[i];
    if (moved) {
      motion.velocity_m_per_s = (contacts[i].position_m - motion.position_m) / dt_s;
    }
    motion.position_m = contacts[i].position_m;
  }
  time_ns_ = now_ns;
  if (thread_.joinable()) {
    wish_.write(motions_);
  } else if (!stop_.load()) {
    load_all();
  }
  piece_ = cache_.take();
}

std::int32_t StreamedElements::active_row(const SurfacePiece& piece,
                                          const ToolState& contact,
                                          std::int32_t in_use) {
  SurfacePoint point;
  if (in_use >= 0) {
    point = piece.search().walk(contact.position_m, in_use);
  } else {
    point = piece.search().nearest(contact.position_m);
    if (!(point.distance_m < piece.missing_distance_m(contact.position_m))) {
      return -1;
    }
  }
  return point.triangle >= 0 && piece.is_surrounded(point.triangle) ? point.triangle
                                                                    : -1;
}

WantedTriangles StreamedElements::wanted(const ToolState& contact) {
  ++updates_;
  const bool walk = is_in_use(contact, cache_.index().triangles());
  const std::int32_t in_use =
      piece_ != nullptr && walk ? piece_->row_of(contact.triangle) : -1;
  const std::int32_t active =
      piece_ == nullptr ? -1 : active_row(*piece_, contact, in_use);
  WantedTriangles sure;
  if (active < 0) {
    ++starved_;
    return sure;
  }
  bool complete = !walk || (in_use >= 0 && piece_->is_surrounded(in_use));
  const WantedTriangles rows = wanted_triangles(piece_->search(), active, in_use);
  for (std::size_t i = 0; i < rows.count; ++i) {
    if (piece_->is_surrounded(rows.triangle[i])) {
      sure.triangle[sure.count++] = piece_->source_of(rows.triangle[i]);
    } else {
      complete = false;
    }
  }
  starved_ += complete ? 0 : 1;
  return sure;
}

Element StreamedElements::element(std::int32_t triangle) const {
  return piece_->element(piece_->row_of(triangle));
}

ElementRows StreamedElements::rows(std::int32_t triangle) const {
  return piece_->compliance(piece_->row_of(triangle));
}

StreamReport StreamedElements::report() const {
  return {.cache = cache_.counts(),
          .updates = updates_,
          .starved = starved_,
          .fault = cache_.is_damaged() ? cache_.damage() : ""};
}

void StreamReport::add(const StreamReport& other) {
  cache.loaded += other.cache.loaded;
  cache.evicted += other.cache.evicted;
  cache.wanted += other.cache.wanted;
  cache.hits += other.cache.hits;
  cache.pieces += other.cache.pieces;
  cache.bytes += other.cache.bytes;
  cache.bytes_max += other.cache.bytes_max;
  cache.loss.add(other.cache.loss);
  cache.load_time.add(other.cache.load_time);
  updates += other.updates;
  starved += other.starved;
  fault = fault.empty() ? other.fault : fault;
}

}  // namespace palpate
