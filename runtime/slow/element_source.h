// Who answers the tool's pose with surface elements: a seam, because a body may lie in
// memory or be streamed from its file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "runtime/element/element.h"
#include "runtime/needle/channel.h"
#include "runtime/realtime/spsc_ring.h"
#include "runtime/slow/tool_state.h"

namespace palpate {

/// Four slow updates of an active element with all its neighbours.
constexpr std::size_t kElementFifoCapacity = 128;
using ElementFifo = SpscRing<Element, kElementFifoCapacity>;

/// One thread, the slow one.
class ElementSender {
 public:
  ElementSender() = default;
  virtual ~ElementSender() = default;
  ElementSender(const ElementSender&) = delete;
  ElementSender& operator=(const ElementSender&) = delete;

  /// One slow step. The step pushes the active element first, then the triangles around
  /// it. Then come those across the edges of the element that the fast process is in,
  /// if that is another part of the surface. In contact the search walks from that
  /// element; in free space it looks at the whole body. A position that is not finite
  /// sends nothing.
  /// @returns messages pushed; what does not fit is dropped and counted by the ring.
  virtual std::size_t update(const ToolState& tool, std::int64_t now_ns,
                             ElementFifo& fifo) = 0;

  /// The message for one triangle of a body in memory, without sequence and time; none
  /// of another body, or where there is no such triangle.
  [[nodiscard]] virtual std::optional<Element> element_of(std::int32_t triangle) const {
    static_cast<void>(triangle);
    return std::nullopt;
  }

  /// What its tool punctures; of one that does not, no materials.
  [[nodiscard]] virtual PunctureRules puncture() const { return {}; }
};

}  // namespace palpate
