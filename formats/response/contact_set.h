// Tools that touch at several places: a rigid set of spheres, with one table of
// responses for each radius that occurs.
//
// The table of the tool itself answers its first sphere's radius. A tool NAME whose set
// has m radii has m - 1 tables more, of spheres named NAME.2 to NAME.m. These spheres
// have the other radii in the order in which the radii occur; they have no set of their
// own.
#pragma once

#include <string>
#include <vector>

#include "formats/response/tool_shape.h"

namespace palpate {

/// Radii that occur, in this order [m]. @param contact not empty.
[[nodiscard]] std::vector<double> distinct_radii(const ContactSet& contact);

/// By contact which of distinct_radii() it has: 0 the tool's own table.
[[nodiscard]] std::vector<std::size_t> radius_of_contacts(const ContactSet& contact);

/// Name of the table of the i-th radius. @param i 0 for the tool's own.
[[nodiscard]] std::string table_name(const std::string& tool, std::size_t i);

/// The spheres whose responses a tool with contacts needs, itself the first; of others
/// the tool alone.
[[nodiscard]] std::vector<ToolShape> spheres_of(const ToolShape& tool);

}  // namespace palpate
