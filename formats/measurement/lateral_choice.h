// Which columns of a lateral test are what, by words in their names.
#pragma once

#include <string>
#include <vector>

#include "formats/measurement/measurement_file.h"
#include "formats/measurement/table_header.h"

namespace palpate {

/// Fills what is empty of `columns`, whose `lateral` has a value. Names tell apart:
/// - the tangential force: "Fx", "Ft", "friction", "lateral force", "shear force";
/// - the normal force: "Fz", "Fn", "normal load", "preload";
/// - displacements sideways from depths: "depth", "z", "indentation";
/// - a second direction, where there are both of "y" and "Fy".
/// A force with no such word is the tangential one where no other is, else the normal
/// one. What only one column can be is left to columns_of_lines().
/// @param file for messages. @param notes a clause for every choice; may be null.
/// @throws InputError where several columns have the same part, or where all forces are
/// normal.
void take_lateral_columns(const std::string& file, const TableHeader& header,
                          MeasurementColumns& columns, std::vector<std::string>* notes);

}  // namespace palpate
