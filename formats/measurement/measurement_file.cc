#include "formats/measurement/measurement_file.h"

#include "formats/measurement/delimited_text.h"
#include "formats/measurement/text_table.h"

namespace palpate {

MeasurementFile read_measurement(const std::filesystem::path& file,
                                 const MeasurementColumns& columns,
                                 HeaderUnits header_units) {
  return read_table(file.string(), read_text_lines(file), columns, header_units);
}

MeasurementFile read_measurement(const std::filesystem::path& file,
                                 const MeasurementColumn& depth,
                                 const MeasurementColumn& force,
                                 HeaderUnits header_units) {
  return read_measurement(file, {depth, force, std::nullopt}, header_units);
}

}  // namespace palpate
