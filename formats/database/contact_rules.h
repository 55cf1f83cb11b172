// The rules of FORMAT.md for pressures and lateral stiffnesses.
#pragma once

#include <cstdint>
#include <string>

#include "formats/response/contact_table.h"

namespace palpate {

/// The rows of some nodes, or no rows. @param tool the group: "/tools/ball".
/// @param first of the nodes, for the message.
/// @throws FormatError naming the dataset, the node and what it must be.
void check_contact(const std::string& tool, const ContactTable& table,
                   std::int64_t nodes, std::int64_t first = 0);

}  // namespace palpate
