// Which columns of a table are the depth and the force, as far as its header tells.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "formats/measurement/delimited_text.h"
#include "formats/measurement/measurement_file.h"

namespace palpate {

/// The only column of lengths is the depth, the only one of forces the force. Both have
/// the header's units, which may stand in a line of their own below the names. Several
/// columns that state the same are one: a gap beside a displacement, whose sum does not
/// change, or a force in two units. One reading of 50 may be wild. Taken is a column
/// without wild readings, of these the first whose values move upwards from where they
/// begin; a note says so.
/// Of a lateral test names choose among several (lateral_choice.h).
/// @param file for messages. @param given columns with a name are kept, and units that
/// are not empty. @param notes a clause for every choice among several; may be null.
/// @throws InputError where there is none, or several that differ, naming those that
/// there are.
[[nodiscard]] MeasurementColumns columns_of_lines(
    const std::string& file, std::span<const TextLine> lines,
    const MeasurementColumns& given, std::vector<std::string>* notes = nullptr);

}  // namespace palpate
