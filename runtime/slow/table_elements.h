// The surface elements of one table of responses, wherever the table lies. One contact
// gets them as they are, several contacts with rows of the table of compliance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/response/compliance_table.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/slow/element_message.h"
#include "runtime/slow/element_source.h"
#include "runtime/slow/tool_state.h"

namespace palpate {

/// The row of a node, of a body whose forces are multiplied by force_scale: as much
/// softer. @param force_scale [-] (0, 1]
[[nodiscard]] ContactRow contact_row(const ComplianceTable& table, std::int64_t node,
                                     double force_scale);

using ElementRows = std::array<ContactRow, 3>;  ///< of an element's nodes

/// One thread, the slow one.
class TableElements : public ElementSender {
 public:
  /// Where all the contacts are that an update is about. Positions are finite.
  virtual void follow(std::span<const ToolState> contacts) {
    static_cast<void>(contacts);
  }

  /// What one of those contacts needs, as update() sends it; nothing where that is not
  /// surely known.
  [[nodiscard]] virtual WantedTriangles wanted(const ToolState& contact) = 0;

  /// The message for a triangle that wanted() named since follow(), without sequence
  /// and time.
  [[nodiscard]] virtual Element element(std::int32_t triangle) const = 0;

  /// Rows of compliance of the same; zero where contacts do not couple.
  [[nodiscard]] virtual ElementRows rows(std::int32_t triangle) const = 0;

  /// What thinning of its curves has cost so far; not while another thread loads.
  [[nodiscard]] virtual const ResampleLoss& resample_loss() const noexcept = 0;

  std::size_t update(const ToolState& tool, std::int64_t now_ns,
                     ElementFifo& fifo) final;

 private:
  std::uint64_t sequence_ = 0;
};

/// Whether the fast process is in an element of a body of that many triangles.
[[nodiscard]] inline bool is_in_use(const ToolState& contact,
                                    std::int64_t triangles) noexcept {
  return contact.in_contact && contact.triangle >= 0 && contact.triangle < triangles;
}

}  // namespace palpate
