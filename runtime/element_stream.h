// The slow process: from the tool's latest pose to the surface elements that the fast
// process needs next (paper, 5.2.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "formats/response_database.h"
#include "runtime/fast/element.h"
#include "runtime/spsc_ring.h"
#include "runtime/surface_search.h"
#include "runtime/tool_state.h"

namespace palpate {

/// Four slow updates of an active element with all its neighbours.
constexpr std::size_t kElementFifoCapacity = 64;
using ElementFifo = SpscRing<Element, kElementFifoCapacity>;

/// Elements sent with the active one, at most: all of an update and the element in use
/// fit the fast process's cache (kCacheSlots), so that an update does not push itself
/// out.
constexpr std::size_t kNeighboursMax = 12;

/// Curves that had to be thinned to fit a message, and what that cost.
struct ResampleLoss {
  std::int64_t nodes = 0;       ///< nodes with more than kElementSamples samples
  double force_n = 0.0;         ///< [N] largest difference of force
  double force_relative = 0.0;  ///< [-] largest, relative to the curve's largest force
};

/// Sends the element nearest to the tool and those around it. One thread; allocates in
/// the constructor only.
class ElementStream {
 public:
  /// Both must outlive the stream; `table` belongs to the database.
  /// @param force_scale [-] (0, 1] forces are multiplied by it, for a device that
  /// cannot render the body's stiffness.
  ElementStream(const ResponseDatabase& database, const ResponseTable& table,
                double force_scale = 1.0);

  /// One slow step: pushes the active element first, then the triangles around it, then
  /// those across the edges of the element that the fast process is in, if that is
  /// another part of the surface. In contact the search walks from that element; in
  /// free space it looks at the whole body. A position that is not finite sends
  /// nothing.
  /// @returns messages pushed; what does not fit is dropped and counted by the ring.
  std::size_t update(const ToolState& tool, std::int64_t now_ns, ElementFifo& fifo);

  /// The message for one triangle, without sequence and time. A node without response
  /// has no samples and no direction: zero force.
  [[nodiscard]] Element element(std::int32_t triangle) const;

  [[nodiscard]] const ResampleLoss& resample_loss() const noexcept { return loss_; }
  [[nodiscard]] const SurfaceSearch& search() const noexcept { return search_; }

 private:
  [[nodiscard]] ElementNode make_node(std::int32_t node, double* loss_n) const;
  bool send(std::int32_t triangle, bool active, std::int64_t now_ns, ElementFifo& fifo);

  const ResponseDatabase& database_;
  const ResponseTable& table_;
  double force_scale_;
  SurfaceSearch search_;
  std::unordered_map<std::int32_t, ElementNode> thinned_;  // too costly at every send
  ResampleLoss loss_;
  std::uint64_t sequence_ = 0;
};

}  // namespace palpate
