// How a database holds pressures and lateral stiffnesses: in whole files and in chunks.
// database_layout.h has the rest. Only for the sources behind response_database.h and
// database_index.h.
#pragma once

#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "formats/response/contact_table.h"
#include "formats/stored/stored_reader.h"

namespace palpate::content {

/// @param tool the group of the tool. `File` as in database_layout.h.
template <typename File, typename Table>
void exchange_contact(File& file, const std::string& tool, Table& table) {
  const bool pressure = file.optional_group(tool + "/pressure", table.has_pressure());
  const bool lateral = file.optional_group(tool + "/lateral", table.has_lateral());
  for_each_contact_dataset(
      table, [&](const std::string& name, const char* units,
                 [[maybe_unused]] Eigen::Index columns, auto& rows) {
        if (!(name.starts_with("/pressure") ? pressure : lateral)) {
          return;
        }
        file.dataset(tool + name, units, rows);
        if constexpr (!File::kWrites) {
          if (rows.cols() != columns) {
            file.fail(fmt::format("dataset {}{} has {} columns, must have {}", tool,
                                  name, rows.cols(), columns));
          }
        }
      });
}

/// The rows [begin, begin + count) of nodes.
inline void read_contact_rows(const StoredReader& file, const std::string& tool,
                              std::int64_t begin, std::int64_t count,
                              ContactTable& part) {
  for_each_contact_dataset(part, [&](const std::string& name, const char* units,
                                     Eigen::Index columns, RowsOf<float>& rows) {
    if (file.has(tool + name)) {
      rows.resize(count, columns);
      file.rows(tool + name, units, StoredType::kFloat32, begin, count, columns,
                rows.data());
    }
  });
}

}  // namespace palpate::content
