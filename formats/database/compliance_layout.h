// How a database holds the coupling of contacts: in whole files and in chunks.
// database_layout.h has the rest. Only for the sources behind response_database.h and
// database_index.h.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/shape_layout.h"
#include "formats/response/compliance_table.h"
#include "formats/stored/stored_reader.h"

namespace palpate::content {

constexpr const char* kComplianceUnits = "m2 N-1";
constexpr const char* kModeUnits = "m0.5 N-0.5";

template <typename File, typename Values>
void exchange_if_any(File& file, const std::string& path, const char* units,
                     Values& values) {
  if (file.optional_dataset(path, values.size() > 0)) {
    file.dataset(path, units, values);
  }
}

// Of how contacts couple what is the same for all nodes.
template <typename File, typename Table>
void exchange_compliance_head(File& file, const std::string& group, Table& table) {
  std::int64_t convex = table.convex ? 1 : 0;
  file.attribute(group, "convex", convex);
  exchange_number(file, group, "error_relative", table.error_relative);
  exchange_number(file, group, "added_modes", table.added_modes);
  file.dataset(group + "/distance_m", "m", table.distance_m);
  if constexpr (!File::kWrites) {
    table.convex = convex != 0;
  }
}

// The one place where the group's name stands.
inline std::string compliance_group(const std::string& tool) {
  return tool + "/compliance";
}

template <typename File, typename Table>
void exchange_compliance(File& file, const std::string& tool, Table& table) {
  const std::string group = compliance_group(tool);
  if (file.optional_group(group, !table.empty())) {
    exchange_compliance_head(file, group, table);
    file.dataset(group + "/value", kComplianceUnits, table.value);
    exchange_if_any(file, group + "/mode", kModeUnits, table.mode);
  }
}

inline void read_compliance_rows(const StoredReader& file, const std::string& group,
                                 std::int64_t begin, std::int64_t count,
                                 const ComplianceTable& head, ComplianceTable& part) {
  part = head;
  const auto rows = [&](const char* name, const char* units, RowsOf<float>& values) {
    const std::int64_t columns = values.cols();
    if (columns > 0) {
      values.resize(count, columns);
      file.rows(group + name, units, StoredType::kFloat32, begin, count, columns,
                values.data());
    }
  };
  rows("/value", kComplianceUnits, part.value);
  rows("/mode", kModeUnits, part.mode);
}

}  // namespace palpate::content
