// Measured numbers, to rounding: relative, and `absolute` where a zero is expected.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {

inline void expect_near(const std::vector<double>& found,
                        const std::vector<double>& exact, double absolute = 0.0) {
  ASSERT_EQ(found.size(), exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(found[i], exact[i], 1e-12 * std::abs(exact[i]) + absolute) << i;
  }
}

}  // namespace palpate
