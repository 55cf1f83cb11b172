#include "runtime/slow/chunk_cache.h"

#include <algorithm>
#include <exception>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

// Of the horizon: time to put a piece together and to have it taken.
constexpr double kSoonShare = 0.3;

void check(const CacheOptions& options) {
  if (!(options.force_scale > 0.0 && options.force_scale <= 1.0)) {
    throw InputError(
        fmt::format("force scale is {}, must lie in (0, 1]", options.force_scale));
  }
  if (!(options.horizon_s >= 0.0 && options.horizon_s <= 10.0)) {
    throw InputError(
        fmt::format("horizon is {} s, must lie in [0, 10]", options.horizon_s));
  }
}

double mebibytes(std::size_t bytes) {
  return static_cast<double>(bytes) / static_cast<double>(kMebibyte);
}

}  // namespace

ChunkCache::ChunkCache(const StoredSource& file, const CacheOptions& options)
    : reader_(file), options_(options) {
  check(options);
  const DatabaseIndex& index = reader_.index();
  content_.tool = find_tool(index, options.tool);
  if (!options.coupling.empty()) {
    content_.coupling = find_tool(index, options.coupling);
  }
  const auto chunks = static_cast<std::size_t>(index.chunks());
  last_use_.assign(chunks, 0);
  needs_.resize(chunks);
  unreadable_.assign(chunks, 0);
  const std::size_t least = least_budget(index, content_, options.spread);
  if (options.budget_bytes < least) {
    throw InputError(
        fmt::format("{}: {:.3g} MiB, the share of tool \"{}\" in the stream budget, "
                    "does not hold a "
                    "neighbourhood of chunks, which needs {:.3g} MiB",
                    file.name(), mebibytes(options.budget_bytes),
                    index.tools[content_.tool].tool.name, mebibytes(least)));
  }
}

const SurfacePiece* ChunkCache::take() noexcept {
  if (published_.fetch()) {
    taken_.store(published_.latest().number, std::memory_order_release);
  }
  return published_.latest().piece;
}

void ChunkCache::give_up(const char* why) noexcept {
  if (!is_damaged()) {
    try {
      damage_ = std::string("loading-failed: ") + why;
    } catch (const std::exception&) {
      damage_.clear();  // no memory for a reason either
    }
    damaged_.store(true, std::memory_order_release);
  }
  given_up_.store(true, std::memory_order_release);
}

void ChunkCache::follow(std::span<const ToolMotion> contacts) {
  contacts_.assign(contacts.begin(), contacts.end());
  settled_ = false;
  choose();
  counts_.wanted += std::ssize(chosen_);
  counts_.hits += std::ranges::count_if(chosen_, [&](std::int64_t k) {
    return loaded_.contains(k);
  });
}

bool ChunkCache::step() {
  drop_taken_pieces();
  if (settled_) {
    return false;
  }
  const bool all_loaded = std::ranges::all_of(chosen_, [&](std::int64_t k) {
    return loaded_.contains(k);
  });
  if (!pieces_.empty() && pieces_.back().number != taken_.load()) {
    return !all_loaded && load_next();  // one waits to be taken
  }
  if (publish(all_loaded)) {
    return true;
  }
  settled_ = all_loaded;
  return !all_loaded && load_next();
}

// Chunks near the tool, each followed by those that it needs, as far as half the budget
// goes: the other half holds what is in use.
void ChunkCache::choose() {
  const DatabaseIndex& index = reader_.index();
  ++choice_;
  chosen_.clear();
  auto bytes = static_cast<std::size_t>(index.chunks());  // of a piece's own list
  const auto add = [&](std::int64_t k) {
    const auto i = static_cast<std::size_t>(k);
    if (last_use_[i] == choice_ || unreadable_[i] != 0) {
      return true;
    }
    bytes += bytes_in_use(index, content_, k);
    if (bytes > options_.budget_bytes / 2) {
      return false;
    }
    last_use_[i] = choice_;
    chosen_.push_back(k);
    return true;
  };
  for (const std::int64_t k : chunks_near(index, contacts_, options_.horizon_s)) {
    if (!add(k) || !std::ranges::all_of(needs_[static_cast<std::size_t>(k)], add)) {
      return;
    }
  }
}

bool ChunkCache::load_next() {
  const auto next = std::ranges::find_if(chosen_, [&](std::int64_t k) {
    return !loaded_.contains(k);
  });
  const std::int64_t k = *next;
  const std::size_t bytes = chunk_bytes(reader_.index(), content_, k);
  if (!make_room(bytes)) {
    return false;  // until the piece that waits is taken
  }
  use(bytes);
  MonotonicClock clock;
  const std::int64_t begin_ns = clock.now_ns();
  try {
    auto chunk = load_chunk(reader_, content_, k, options_.force_scale);
    needs_[static_cast<std::size_t>(k)] = chunk->needs;
    counts_.loss.add(chunk->loss);
    loaded_.emplace(k, std::move(chunk));
  } catch (const Error& error) {
    counts_.bytes -= bytes;
    unreadable_[static_cast<std::size_t>(k)] = 1;
    if (!is_damaged()) {
      damage_ = std::string("damaged-chunk: ") + error.what();
      damaged_.store(true, std::memory_order_release);
    }
    choose();
    return true;
  }
  ++counts_.loaded;
  counts_.load_time.add(clock.now_ns() - begin_ns);
  choose();  // what it needs is known now
  return true;
}

// A new piece once all that was chosen is there, or earlier, if it has a chunk that the
// tool reaches soon and the last one lacks; never while one waits to be taken.
bool ChunkCache::publish(bool all_loaded) {
  const SurfacePiece* last = pieces_.empty() ? nullptr : pieces_.back().piece.get();
  LoadedChunks chunks;
  for (const std::int64_t k : chosen_) {
    if (const auto found = loaded_.find(k); found != loaded_.end()) {
      chunks.insert(*found);
    }
  }
  // News: all chunks that its triangles need are loaded, and the last piece lacked
  // some.
  const auto is_news = [&](const auto& entry) {
    return is_complete(chunks, *entry.second) &&
           (last == nullptr || !last->has_complete(entry.first));
  };
  const double soon_s = kSoonShare * options_.horizon_s;
  const bool urgent =
      !all_loaded &&
      std::ranges::any_of(chunks_near(reader_.index(), contacts_, soon_s),
                          [&](std::int64_t k) {
                            const auto found = chunks.find(k);
                            return found != chunks.end() && is_news(*found);
                          });
  if (!urgent && !(all_loaded && std::ranges::any_of(chunks, is_news))) {
    return false;
  }
  // One byte a chunk, SurfacePiece::complete_, and what the chunks' nodes and triangles
  // take.
  std::size_t bytes = static_cast<std::size_t>(reader_.index().chunks());
  for (const auto& [k, chunk] : chunks) {
    bytes += piece_bytes(reader_.index(), k);
  }
  if (!make_room(bytes)) {
    return false;
  }
  use(bytes);
  ++counts_.pieces;
  pieces_.push_back({std::make_unique<const SurfacePiece>(
                         reader_.index(), std::move(chunks), options_.force_scale),
                     ++number_, bytes});
  published_.write({pieces_.back().piece.get(), number_});
  return true;
}

// Pieces hold their chunks; nobody else does.
bool ChunkCache::is_pinned(std::int64_t chunk) const {
  return loaded_.at(chunk).use_count() > 1;
}

bool ChunkCache::make_room(std::size_t bytes) {
  while (counts_.bytes + bytes > options_.budget_bytes) {
    auto oldest = loaded_.end();
    for (auto it = loaded_.begin(); it != loaded_.end(); ++it) {
      const auto k = static_cast<std::size_t>(it->first);
      if (last_use_[k] != choice_ && !is_pinned(it->first) &&
          (oldest == loaded_.end() ||
           last_use_[k] < last_use_[static_cast<std::size_t>(oldest->first)])) {
        oldest = it;
      }
    }
    if (oldest == loaded_.end()) {
      return false;
    }
    counts_.bytes -= chunk_bytes(reader_.index(), content_, oldest->first);
    loaded_.erase(oldest);
    ++counts_.evicted;
  }
  return true;
}

void ChunkCache::drop_taken_pieces() {
  const std::uint64_t taken = taken_.load(std::memory_order_acquire);
  while (!pieces_.empty() && pieces_.front().number < taken) {
    counts_.bytes -= pieces_.front().bytes;
    pieces_.pop_front();
  }
}

void ChunkCache::use(std::size_t bytes) {
  counts_.bytes += bytes;
  counts_.bytes_max = std::max(counts_.bytes_max, counts_.bytes);
}

}  // namespace palpate
