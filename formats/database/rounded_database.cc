#include "formats/database/rounded_database.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/select_nodes.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

void round_values(std::span<double> values, Precision precision) {
  const double scale = int16_scale(values);
  for (double& value : values) {
    if (precision == Precision::kFloat32) {
      value = static_cast<double>(static_cast<float>(value));
    } else {
      value = scale > 0.0 ? std::round(value / scale) * scale : 0.0;
    }
  }
}

void round_table(ResponseTable& table, Precision precision) {
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    const auto begin = static_cast<std::size_t>(table.sample_begin[node]);
    const auto count = static_cast<std::size_t>(table.sample_begin[node + 1]) - begin;
    const std::span depth = std::span(table.depth_m).subspan(begin, count);
    const std::span force = std::span(table.force_n).subspan(begin, count);
    round_values(depth, precision);
    round_values(force, precision);
    // Two depths that became one would have no slope between them.
    const auto twin = std::adjacent_find(depth.begin(), depth.end());
    if (twin != depth.end()) {
      throw InputError(
          fmt::format("tool {:?}: node {}: {} cannot tell its depths at {} m apart, "
                      "store it as float64",
                      table.tool.name, i, name_of(precision), *twin));
    }
    const bool falls = !std::is_sorted(force.begin(), force.end());
    table.flags[node] = static_cast<std::uint8_t>(
        falls ? table.flags[node] | kFallingCurve : table.flags[node] & ~kFallingCurve);
  }
  // Slopes and energies of the rounded samples, so that E' = f still holds.
  remake_curves(table);
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    table.stiffness_max_n_per_m[static_cast<std::size_t>(i)] =
        stiffness_max_n_per_m(table.curve(i));
  }
}

}  // namespace

ResponseDatabase rounded(const ResponseDatabase& database) {
  ResponseDatabase result = database;
  if (database.storage.precision != Precision::kFloat64) {
    for (ResponseTable& table : result.tools) {
      round_table(table, database.storage.precision);
    }
  }
  return result;
}

}  // namespace palpate
