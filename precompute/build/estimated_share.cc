#include "precompute/build/estimated_share.h"

#include <algorithm>
#include <cmath>

#include "formats/base/reproducible.h"

namespace palpate {

double share_above(std::span<const double> values, double limit) {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : values) {
    if (value > 0.0) {
      const double x = reproducible::log(value / limit);
      ++count;
      sum += x;
      squares += x * x;
    }
  }
  if (count < 2.0) {
    return 0.0;
  }
  const double mean = sum / count;
  const double deviation =
      std::sqrt(std::max(squares - count * mean * mean, 1e-12) / (count - 1.0));
  return 0.5 * reproducible::erfc(-mean / (std::sqrt(2.0) * deviation));
}

}  // namespace palpate
