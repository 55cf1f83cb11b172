// The slow process: from the tool's latest pose to the surface elements that the fast
// process needs next (paper, 5.2.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/mesh/surface_search.h"
#include "runtime/slow/element_message.h"
#include "runtime/slow/node_puncture.h"
#include "runtime/slow/table_elements.h"

namespace palpate {

/// Sends the element nearest to the tool and those around it, of a database in memory.
/// Allocates in the constructor only.
class ElementStream : public TableElements {
 public:
  /// All must outlive the stream; `table` belongs to the database.
  /// @param force_scale [-] (0, 1] forces are multiplied by it, for a device that
  /// cannot render the body's stiffness. @param coupling whose rows go along; null:
  /// contacts do not couple.
  ElementStream(const ResponseDatabase& database, const ResponseTable& table,
                double force_scale = 1.0, const ComplianceTable* coupling = nullptr);

  [[nodiscard]] WantedTriangles wanted(const ToolState& contact) override;

  /// Of any triangle of the body. A node without response has no samples and no
  /// direction: zero force.
  [[nodiscard]] Element element(std::int32_t triangle) const override;
  [[nodiscard]] ElementRows rows(std::int32_t triangle) const override;
  [[nodiscard]] std::optional<Element> element_of(
      std::int32_t triangle) const override {
    const bool there = triangle >= 0 && triangle < database_.body.triangle.rows();
    return there ? std::optional(element(triangle)) : std::nullopt;
  }

  [[nodiscard]] PunctureRules puncture() const override {
    return puncture_rules(rows_.table.puncture, rows_.force_scale);
  }

  [[nodiscard]] const ResampleLoss& resample_loss() const noexcept override {
    return loss_;
  }
  [[nodiscard]] const SurfaceSearch& search() const noexcept { return search_; }

 private:
  const ResponseDatabase& database_;
  const ComplianceTable* coupling_;
  /// The table with curves as they are rendered; none where they are so already.
  std::optional<ResponseTable> instantaneous_;
  std::vector<TiltLine> tilt_;
  NodeRows rows_;
  SurfaceSearch search_;
  ResampleLoss loss_;
  std::unordered_map<std::int32_t, ElementNode> thinned_;
};

}  // namespace palpate
