// The rules of FORMAT.md for the parts of a database that not every file has.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/response_database.h"

namespace palpate {

/// @param group e.g. "/tools/ball". @param table has passed the rules for what every
/// tool has. @throws FormatError with the first violation.
void check_optional(const std::string& group, const ResponseTable& table);

/// Of a tool, in the group that holds it. @throws FormatError with the first violation.
void check_relaxation(const std::string& group, const ResponseRelaxation& relaxation,
                      std::int64_t nodes);

/// @param nodes of the body. @throws FormatError with the first violation.
void check(const Measurement& measurement, std::int64_t nodes);

}  // namespace palpate
