// A database as one HTML page that needs nothing else.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/response_database.h"

namespace palpate {

/// Nodes that a page shows at most, over all tools; a page is some 15 MB then.
constexpr std::int64_t kReportNodes = 12000;

/// The body, turnable and coloured by stiffness at a depth, largest slope and depth,
/// errors or origin. A histogram of stiffness; the curve of a chosen node; tools,
/// accuracy and provenance. Curves are the database's own, in single precision. A body
/// of more nodes is thinned (thin_body), which the page says. The page asks for nothing
/// from elsewhere, and forbids itself to. @param name of the file, for the title.
[[nodiscard]] std::string report_page(const ResponseDatabase& database,
                                      const std::string& name,
                                      std::int64_t most_nodes = kReportNodes);

}  // namespace palpate
