// The tick of the fast loop in tests.
#pragma once

namespace palpate {

inline constexpr double kTickS = 0.0005;  // 2 kHz

}  // namespace palpate
