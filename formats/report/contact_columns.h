// What a contact knows at the samples of a node's curve, in the columns of exports.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "formats/response/response_table.h"

namespace palpate {

/// [m] of the pressure at a sample; 0 where it is not known.
[[nodiscard]] double contact_radius_m(const ResponseTable& table, std::int64_t node,
                                      std::size_t sample);

/// K = S N / d there [N/m]: xx, xy, yy in the node's frame (contact_table.h). At the
/// touch N / d is the curve's slope. 0 where it is not known.
[[nodiscard]] std::array<double, 3> lateral_n_per_m(const ResponseTable& table,
                                                    std::int64_t node,
                                                    std::size_t sample);

/// ",contact_radius_m,lateral_xx_n_per_m,...", each where the table has it.
[[nodiscard]] std::string contact_columns(const ContactTable& contact);

/// A sample's values of these columns.
[[nodiscard]] std::string contact_values(const ResponseTable& table, std::int64_t node,
                                         std::size_t sample);

}  // namespace palpate
