// What tables of compliance and sets of contacts must keep (FORMAT.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/response/compliance_table.h"
#include "formats/response/response_table.h"

namespace palpate {

/// All but the nodes' rows. @param tool "/tools/<name>".
/// @throws FormatError naming dataset and value.
void check_compliance_head(const std::string& tool, const ComplianceTable& table);

/// Rows of some nodes, `first` the first of them.
/// @throws FormatError naming dataset, row and value.
void check_compliance_rows(const std::string& tool, const ComplianceTable& table,
                           std::int64_t nodes, std::int64_t first = 0);

/// Every radius that a tool's contacts have has a table of a sphere of that radius.
/// @throws FormatError naming the tool whose table is missing or another.
void check_contact_tables(const std::vector<ResponseTable>& tables);

}  // namespace palpate
