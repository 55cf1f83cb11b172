#include "formats/database/contact_rules.h"

#include "formats/database/format_error.h"

namespace palpate {

void check_contact(const std::string& tool, const ContactTable& table,
                   std::int64_t nodes, std::int64_t first) {
  const auto wanted = [&](bool there) {
    return there ? nodes : 0;
  };
  for_each_contact_dataset(table, [&](const std::string& name, const char* /*units*/,
                                      Eigen::Index columns, const RowsOf<float>& rows) {
    const bool there =
        name.starts_with("/pressure") ? table.has_pressure() : table.has_lateral();
    if (rows.rows() != wanted(there) || (there && rows.cols() != columns)) {
      fail("{}{} has {} x {} numbers, must have {} x {}", tool, name, rows.rows(),
           rows.cols(), wanted(there), columns);
    }
  });
  for (std::int64_t i = 0; i < nodes; ++i) {
    const std::string wrong = broken_contact_row(table, i);
    if (!wrong.empty()) {
      fail("{}: node {} has a {}", tool, first + i, wrong);
    }
  }
}

}  // namespace palpate
