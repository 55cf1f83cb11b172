// The slow process of a tool with several contacts, or of two hands on one body: for
// each contact the element nearest to it and those around it, with the rows of the
// table of compliance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/contacts/coupled_field.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/realtime/spsc_ring.h"
#include "runtime/slow/memory_elements.h"
#include "runtime/slow/tool_state.h"

namespace palpate {

/// One update of 64 contacts that all lie in other elements. About 6 MB.
constexpr std::size_t kContactFifoCapacity = 1024;
using ContactFifo = SpscRing<ContactElement, kContactFifoCapacity>;

/// What the fast process tells the slow one of all contacts.
struct ContactToolState {
  std::uint64_t sequence = 0;  ///< counts fast ticks from 1; 0: nothing written yet
  std::int32_t count = 0;
  std::array<ToolState, kContactsMax> contact;
};

/// Where the contacts of a coupled fast process are. @param ticks from 1.
[[nodiscard]] ContactToolState contact_tool_state(const CoupledState& state,
                                                  std::uint64_t ticks) noexcept;

/// The row of a node, of a body whose forces are multiplied by force_scale: as much
/// softer. @param force_scale [-] (0, 1]
[[nodiscard]] ContactRow contact_row(const ComplianceTable& table, std::int64_t node,
                                     double force_scale);

/// Responses of a tool's radius number r (radius_of_contacts()).
[[nodiscard]] const ResponseTable& table_of_radius(const ResponseDatabase& database,
                                                   const ResponseTable& tool,
                                                   std::size_t radius);

/// The contacts of tools that press one body together, each in a hand of its own. A
/// tool without a contact set is one sphere of its nominal radius.
/// @param tools (1 to kPortsMax) of the database. The first one's table of compliance
/// couples all.
/// @throws InputError, in one sentence, where there are several contacts and a tool has
/// no table of compliance, or relaxes with curves of a press; or too many
/// contacts or radii.
[[nodiscard]] CoupledSet coupled_set(const ResponseDatabase& database,
                                     std::span<const ResponseTable* const> tools);

/// What was last sent for each contact of a tool. An element is sent when a contact's
/// surroundings change. At every update one contact in turn, of more than 8 every
/// eighth, is sent again: so that what was dropped comes back, and something always
/// says that the slow process is there.
struct ContactSent {
  static constexpr int kRepeatUpdates = 8;  ///< at most, until each comes again
  struct Contact {
    WantedTriangles wanted;
    bool whole = false;  ///< nothing of it was dropped
  };
  std::array<Contact, kContactsMax> contact;
  std::uint64_t updates = 0;
};

/// Of a database in memory, for any number of tools of one kind. Allocates in the
/// constructor only.
class ContactStream {
 public:
  /// The database must outlive the stream. @param force_scale [-] (0, 1]
  /// @throws as coupled_set().
  ContactStream(const ResponseDatabase& database,
                std::span<const ResponseTable* const> tools, double force_scale = 1.0);

  [[nodiscard]] const CoupledSet& set() const noexcept { return set_; }

  /// One slow step of all contacts. @returns messages pushed; what does not fit is
  /// dropped and counted by the ring, and sent again.
  std::size_t update(const ContactToolState& tool, std::int64_t now_ns,
                     ContactFifo& fifo, ContactSent& sent);

  /// The message for one triangle of contact i, without sequence and time.
  [[nodiscard]] ContactElement element(int i, std::int32_t triangle) const;

  [[nodiscard]] std::int32_t triangles() const noexcept {
    return static_cast<std::int32_t>(database_.body.triangle.rows());
  }

 private:
  std::size_t update(int i, const ToolState& at, std::int64_t now_ns, ContactFifo& fifo,
                     ContactSent& sent);

  const ResponseDatabase& database_;
  CoupledSet set_;
  const ComplianceTable* compliance_;                   // null: one contact
  std::vector<std::unique_ptr<ElementStream>> radius_;  // responses of each
  double force_scale_;
  std::uint64_t sequence_ = 0;
};

}  // namespace palpate
