// The exponential with twice a double's digits, for what is computed from it.
#pragma once

#include "formats/base/double_double.h"

namespace palpate::reproducible {

/// exp(x). @param x [-1000, 710]
DoubleDouble long_exp(DoubleDouble x);

}  // namespace palpate::reproducible
