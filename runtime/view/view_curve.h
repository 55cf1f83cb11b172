// The response of a node, for pages that plot it.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/response_database.h"

namespace palpate {

/// The curve of a node, as JSON. @throws InputError for a node that is not there.
[[nodiscard]] std::string curve_text(const ResponseDatabase& database,
                                     const ResponseTable& table, std::int32_t node);

}  // namespace palpate
