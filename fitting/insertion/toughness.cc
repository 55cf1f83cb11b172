#include "fitting/insertion/toughness.h"

#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/puncture.h"

namespace palpate {

IntervalEstimate toughness_of(const IntervalEstimate& cutting_n, double edge_width_m) {
  if (!(edge_width_m > 0.0) || !std::isfinite(edge_width_m)) {
    throw InputError(
        fmt::format("the edge is {} m wide, must be above 0 and finite", edge_width_m));
  }
  IntervalEstimate toughness = cutting_n;
  for (double* value :
       {&toughness.value, &toughness.sd, &toughness.low, &toughness.high}) {
    *value /= edge_width_m;
  }
  return toughness;
}

std::string toughness_warning(const IntervalEstimate& toughness) {
  if (!(toughness.value > kToughestPuncture)) {
    return "";
  }
  return fmt::format(
      "a toughness of {:.0f} J/m2 is above {:.0f} J/m2, which no needle has met in "
      "soft "
      "tissue: is the edge wider, or is a tear test meant? Tear and notch tests give "
      "15 "
      "to 27 times the toughness of a needle",
      toughness.value, kToughestPuncture);
}

}  // namespace palpate
