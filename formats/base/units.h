// Units that people's files carry, and their size in SI base units.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// Metres in one of `unit`: m, dm, cm, mm, um, nm, in.
/// @throws InputError naming the known units.
[[nodiscard]] double metres_per(std::string_view unit);

/// Newtons in one of `unit`: kN, daN, N, cN, mN, uN, nN, pN, gf, kgf, lbf. "µ" may
/// stand for "u".
/// @throws InputError naming the known units.
[[nodiscard]] double newtons_per(std::string_view unit);

/// Seconds in one of `unit`: s, sec, ms, us, ns, min, in upper or lower case: no time
/// unit is another's capital. "µ" may stand for "u".
/// @throws InputError naming the known units.
[[nodiscard]] double seconds_per(std::string_view unit);

}  // namespace palpate
