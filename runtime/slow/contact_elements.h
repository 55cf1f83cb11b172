// The slow process of a tool with several contacts, or of two hands on one body. The
// slow process finds for each contact the nearest element and those around it, with the
// rows of the table of compliance.
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
#include "runtime/slow/table_elements.h"

namespace palpate {

/// Where the contacts of a coupled fast process are. @param ticks from 1.
[[nodiscard]] ContactToolState contact_tool_state(const CoupledState& state,
                                                  std::uint64_t ticks) noexcept;

/// A tool that presses, as it is known before any response is read: of a ResponseTable
/// or a ToolIndex, which must outlive it.
struct PressingTool {
  template <typename Table>
  explicit PressingTool(const Table& table)
      : shape(table.tool),
        compliance(table.compliance),
        relaxation(table.viscoelasticity),
        puncture(table.puncture) {}

  const ToolShape& shape;
  const ComplianceTable& compliance;  ///< its rows are not looked at
  const Viscoelasticity& relaxation;  ///< likewise
  const Puncture& puncture;           ///< likewise
};

/// Responses of a tool's radius number r (radius_of_contacts()).
[[nodiscard]] const ResponseTable& table_of_radius(const ResponseDatabase& database,
                                                   const ResponseTable& tool,
                                                   std::size_t radius);

/// Names of the tables of every radius that occurs, tool by tool: what
/// ContactSphere::table counts. @throws InputError for too many.
[[nodiscard]] std::vector<std::string> response_names(
    std::span<const PressingTool> tools);

/// The tables themselves.
[[nodiscard]] std::vector<const ResponseTable*> response_tables(
    const ResponseDatabase& database, std::span<const ResponseTable* const> tools);

/// The contacts of tools that press one body together, each in a hand of its own. A
/// tool without a contact set is one sphere of its nominal radius.
/// @param tools (1 to kPortsMax). The first one's table of compliance couples all.
/// @throws InputError for coupled contacts of a needle, or of a tool that has no table
/// of compliance or relaxes with curves of a press. @throws InputError for too many
/// contacts or radii.
[[nodiscard]] CoupledSet coupled_set(std::span<const PressingTool> tools);
[[nodiscard]] CoupledSet coupled_set(std::span<const ResponseTable* const> tools);

/// For any number of tools of one kind. Of a database in memory it allocates in the
/// constructor only.
class ContactStream : public ContactSender {
 public:
  /// In memory; the database must outlive the stream. @param force_scale [-] (0, 1]
  /// @throws as coupled_set().
  ContactStream(const ResponseDatabase& database,
                std::span<const ResponseTable* const> tools, double force_scale = 1.0);

  /// Wherever they lie. @param table (response_names()) each one's elements.
  ContactStream(std::span<const PressingTool> tools,
                std::vector<std::unique_ptr<TableElements>> table);

  [[nodiscard]] const CoupledSet& set() const noexcept override { return set_; }

  std::size_t update(const ContactToolState& tool, std::int64_t now_ns,
                     ContactFifo& fifo, ContactSent& sent) override;

  /// response_names().
  [[nodiscard]] const std::vector<std::string>& tables() const noexcept {
    return names_;
  }
  [[nodiscard]] const std::vector<std::unique_ptr<TableElements>>& elements()
      const noexcept {
    return table_;
  }

  /// The message for one triangle of contact i, without sequence and time.
  [[nodiscard]] ContactElement element(int i, std::int32_t triangle) const;
  [[nodiscard]] std::optional<ContactElement> element_of(
      int i, std::int32_t triangle) const override;

 private:
  [[nodiscard]] TableElements& table_of(int i) const;
  void follow(const ContactToolState& tool);
  std::size_t update(int i, const ToolState& at, std::int64_t now_ns, ContactFifo& fifo,
                     ContactSent& sent);

  CoupledSet set_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<TableElements>> table_;
  std::uint64_t sequence_ = 0;
};

}  // namespace palpate
