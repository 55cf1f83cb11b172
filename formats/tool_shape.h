// The rigid tool that presses into a body.
#pragma once

#include <string>

namespace palpate {

/// What touches the body. Its pose is its reference point: a sphere's centre.
struct ToolShape {
  std::string name;             ///< as the scene names it
  std::string kind = "sphere";  ///< the one shape there is so far
  double radius_m = 0.0;        ///< [m] (0, inf)
  double friction = 0.0;        ///< [-] [0, 10] Coulomb coefficient, tangential plane
  double presliding_m =
      0.0;  ///< [m] [0, inf) delta_L, displacement at which sliding starts
};

/// @throws InputError naming the value that is out of range.
void check(const ToolShape& tool);

}  // namespace palpate
