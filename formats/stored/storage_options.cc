#include "formats/stored/storage_options.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

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

}  // namespace palpate
