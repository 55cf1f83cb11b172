// The slow process of a tool with several contacts, or of two hands on one body: for
// each contact the element nearest to it and those around it, with the rows of the
// table of compliance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/contacts/coupled_field.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/slow/contact_source.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {

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

/// Of every radius that occurs, tool by tool: what ContactSphere::table counts.
/// @throws InputError for too many.
[[nodiscard]] std::vector<const ResponseTable*> response_tables(
    const ResponseDatabase& database, std::span<const ResponseTable* const> tools);

/// The contacts of tools that press one body together, each in a hand of its own. A
/// tool without a contact set is one sphere of its nominal radius.
/// @param tools (1 to kPortsMax) of the database. The first one's table of compliance
/// couples all.
/// @throws InputError, in one sentence, where there are several contacts and a tool has
/// no table of compliance, or relaxes with curves of a press; or too many
/// contacts or radii.
[[nodiscard]] CoupledSet coupled_set(const ResponseDatabase& database,
                                     std::span<const ResponseTable* const> tools);

/// Of a database in memory, for any number of tools of one kind. Allocates in the
/// constructor only.
class ContactStream : public ContactSender {
 public:
  /// The database must outlive the stream. @param force_scale [-] (0, 1]
  /// @throws as coupled_set().
  ContactStream(const ResponseDatabase& database,
                std::span<const ResponseTable* const> tools, double force_scale = 1.0);

  [[nodiscard]] const CoupledSet& set() const noexcept override { return set_; }

  std::size_t update(const ContactToolState& tool, std::int64_t now_ns,
                     ContactFifo& fifo, ContactSent& sent) override;

  /// Names of response_tables().
  [[nodiscard]] const std::vector<std::string>& tables() const noexcept {
    return tables_;
  }

  /// The message for one triangle of contact i, without sequence and time.
  [[nodiscard]] ContactElement element(int i, std::int32_t triangle) const;
  [[nodiscard]] std::optional<ContactElement> element_of(
      int i, std::int32_t triangle) const override;

 private:
  std::size_t update(int i, const ToolState& at, std::int64_t now_ns, ContactFifo& fifo,
                     ContactSent& sent);

  const ResponseDatabase& database_;
  CoupledSet set_;
  std::vector<std::string> tables_;
  const ComplianceTable* compliance_;                   // null: one contact
  std::vector<std::unique_ptr<ElementStream>> radius_;  // responses of each
  double force_scale_;
  std::uint64_t sequence_ = 0;
};

}  // namespace palpate
