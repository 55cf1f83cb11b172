// Chunks of a database near a moving tool, within a fixed number of bytes.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/database/chunk_reader.h"
#include "runtime/realtime/step_histogram.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/slow/chunk_choice.h"
#include "runtime/slow/node_puncture.h"
#include "runtime/slow/surface_piece.h"

namespace palpate {

constexpr std::size_t kMebibyte = std::size_t{1} << 20;

struct CacheOptions {
  std::string tool = {};      ///< empty: the only one
  std::string coupling = {};  ///< whose rows of compliance go along; empty: none
  ContactSpread spread = {};  ///< of the contacts that follow() will name
  std::size_t budget_bytes = 48 * kMebibyte;  ///< of chunks and pieces in memory
  double horizon_s = 0.1;    ///< [s] [0, 10] that is prefetched along the motion
  double force_scale = 1.0;  ///< [-] (0, 1]
};

/// What the cache did; of its thread.
struct CacheCounts {
  std::int64_t loaded = 0;   ///< chunks read
  std::int64_t evicted = 0;  ///< chunks given up
  std::int64_t wanted = 0;   ///< chunks that new motions asked for ...
  std::int64_t hits = 0;     ///< ... and of them those in memory already
  std::int64_t pieces = 0;   ///< surfaces put together
  std::size_t bytes = 0;     ///< in use now, at most
  std::size_t bytes_max = 0;
  ResampleLoss loss;        ///< of what was loaded
  StepHistogram load_time;  ///< per chunk
};

/// Two threads: one calls follow() and step(), the other take(); neither ever waits for
/// the other. A piece lives until the other thread has taken a later one. At most one
/// piece waits to be taken, so two neighbourhoods are in memory at most. A chunk that
/// cannot be read is given up for good, and the first such fault kept.
class ChunkCache {
 public:
  /// Reads the index alone. @throws InputError, FormatError as ChunkReader does.
  /// @throws InputError for options out of range, a tool that is not there, or a budget
  /// that does not hold a neighbourhood.
  ChunkCache(const StoredSource& file, const CacheOptions& options);

  /// From now on, what is near any of these contacts is wanted.
  void follow(std::span<const ToolMotion> contacts);

  /// Loads one chunk, or publishes a piece, or has nothing to do (then false). Of what
  /// was used longest ago, as much is given up as the budget needs.
  [[nodiscard]] bool step();

  /// The other thread. The piece published last, valid until the next call; null before
  /// the first. Wait-free.
  [[nodiscard]] const SurfacePiece* take() noexcept;

  [[nodiscard]] const CacheCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] const DatabaseIndex& index() const noexcept { return reader_.index(); }
  [[nodiscard]] std::size_t tool() const noexcept { return content_.tool; }
  /// What the tool punctures.
  [[nodiscard]] PunctureRules puncture() const {
    return puncture_rules(index().tools[tool()].puncture, options_.force_scale);
  }

  /// Any thread. Whether a chunk was damaged.
  [[nodiscard]] bool is_damaged() const noexcept {
    return damaged_.load(std::memory_order_acquire);
  }
  /// Why, by name: "damaged-chunk: ..." or "loading-failed: ..."; only after
  /// is_damaged().
  [[nodiscard]] const std::string& damage() const noexcept { return damage_; }

  /// The loading thread cannot go on (memory, a defect): nothing is handed out any
  /// more.
  void give_up(const char* why) noexcept;
  /// Any thread.
  [[nodiscard]] bool has_given_up() const noexcept {
    return given_up_.load(std::memory_order_acquire);
  }

 private:
  struct Published {
    const SurfacePiece* piece = nullptr;
    std::uint64_t number = 0;
  };
  struct Kept {
    std::unique_ptr<const SurfacePiece> piece;
    std::uint64_t number = 0;
    std::size_t bytes = 0;
  };

  void choose();
  [[nodiscard]] bool load_next();
  [[nodiscard]] bool publish(bool all_loaded);
  [[nodiscard]] bool make_room(std::size_t bytes);
  [[nodiscard]] bool is_pinned(std::int64_t chunk) const;
  void drop_taken_pieces();
  void use(std::size_t bytes);

  ChunkReader reader_;
  CacheOptions options_;
  ChunkContent content_;
  std::vector<ToolMotion> contacts_;
  bool settled_ = true;  // nothing to do until the motion changes
  LoadedChunks loaded_;
  std::vector<std::uint64_t> last_use_;           // (c) by choose()
  std::vector<std::vector<std::int64_t>> needs_;  // (c) known once loaded
  std::vector<std::uint8_t> unreadable_;          // (c)
  std::vector<std::int64_t> chosen_;              // most urgent first
  std::uint64_t choice_ = 0;
  std::deque<Kept> pieces_;   // oldest first
  std::uint64_t number_ = 0;  // of the last piece
  CacheCounts counts_;
  std::string damage_;
  std::atomic<bool> damaged_ = false;
  std::atomic<bool> given_up_ = false;
  TripleBuffer<Published> published_;
  std::atomic<std::uint64_t> taken_ = 0;  // number of the piece in use
};

}  // namespace palpate
