#include "formats/precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "formats/error.h"
#include "formats/response_curve.h"
#include "formats/select_nodes.h"

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
  remake_curves(table);
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    table.stiffness_max_n_per_m[static_cast<std::size_t>(i)] =
        stiffness_max_n_per_m(table.curve(i));
  }
}

}  // namespace

const char* name_of(Precision precision) {
  switch (precision) {
    case Precision::kFloat64:
      return "float64";
    case Precision::kFloat32:
      return "float32";
    case Precision::kInt16:
      break;
  }
  return "int16";
}

Precision precision_of(const std::string& name) {
  for (const Precision precision :
       {Precision::kFloat64, Precision::kFloat32, Precision::kInt16}) {
    if (name == name_of(precision)) {
      return precision;
    }
  }
  throw InputError(
      fmt::format("unknown precision {:?}; there are: float64, float32, int16",
                  name.substr(0, 80)));
}

double int16_scale(std::span<const double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const double exact = *std::max_element(values.begin(), values.end()) / kInt16Steps;
  const auto scale = static_cast<float>(exact);
  return static_cast<double>(
      static_cast<double>(scale) < exact
          ? std::nextafter(scale, std::numeric_limits<float>::infinity())
          : scale);
}

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
