// Surface elements from a database that stays in its file: what is near the tool's
// contacts is in memory, the rest is not.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "runtime/slow/chunk_cache.h"
#include "runtime/slow/table_elements.h"

namespace palpate {

/// What the slow thread saw.
struct StreamReport {
  CacheCounts cache;
  std::int64_t updates = 0;  ///< of a contact, with a finite position
  std::int64_t starved = 0;  ///< of them those that missed a chunk
  std::string fault;         ///< "", or "damaged-chunk: " and what was found

  /// With that of another table of responses.
  void add(const StreamReport& other);
};

/// Reads in a thread of its own, or, for simulated time, at once in update(), so that
/// the same input gives the same bits. follow() takes what is there and never waits. An
/// element is not sent unless it is surely the one that the whole database would give,
/// with what surrounds it. The update then counts as starved, and the fast process
/// keeps the element that it has.
class StreamedElements : public TableElements {
 public:
  /// Loads what is near `start_m` [m] before it returns. @throws as ChunkCache does.
  StreamedElements(const StoredSource& file, const CacheOptions& options,
                   const Eigen::Vector3d& start_m, bool in_thread);
  ~StreamedElements() override;

  void follow(std::span<const ToolState> contacts) override;
  [[nodiscard]] WantedTriangles wanted(const ToolState& contact) override;
  [[nodiscard]] Element element(std::int32_t triangle) const override;
  [[nodiscard]] ElementRows rows(std::int32_t triangle) const override;

  [[nodiscard]] PunctureRules puncture() const override { return cache_.puncture(); }

  [[nodiscard]] const ResampleLoss& resample_loss() const noexcept override {
    return cache_.counts().loss;
  }

  /// Ends the thread; update() then sends what is in memory.
  void stop();

  /// After stop(), or without a thread.
  [[nodiscard]] StreamReport report() const;

  /// Whether a chunk was damaged, any time.
  [[nodiscard]] bool is_damaged() const noexcept { return cache_.is_damaged(); }
  /// Why; only where is_damaged().
  [[nodiscard]] const std::string& damage() const noexcept { return cache_.damage(); }

 private:
  struct Motions {
    std::array<ToolMotion, kContactsMax> contact;
    std::size_t count = 0;
    [[nodiscard]] std::span<const ToolMotion> all() const noexcept {
      return std::span(contact).first(count);
    }
  };

  void load_all();
  void run() noexcept;
  // The active triangle's row; -1 if it is not sure which it is. Without the row in
  // use, left behind by a tool that outran the reading, the nearest one.
  [[nodiscard]] static std::int32_t active_row(const SurfacePiece& piece,
                                               const ToolState& contact,
                                               std::int32_t in_use);

  ChunkCache cache_;
  Motions motions_;                      // slow thread's
  std::int64_t time_ns_ = 0;             // of motions_
  const SurfacePiece* piece_ = nullptr;  // since follow()
  std::int64_t followed_ = 0;
  std::int64_t updates_ = 0;
  std::int64_t starved_ = 0;
  TripleBuffer<Motions> wish_;  // slow to loading thread
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace palpate
