// The beginning of scenes of an organ on a table.
#pragma once

#include <string>

namespace palpate {

/// Body (organ.obj, in metres), material and support; tool, reach and accuracy follow.
inline std::string organ_on_table(const std::string& law) {
  return "[body]\nmesh = \"organ.obj\"\nlength_unit = \"m\"\n"
         "[[material]]\nregion = \"body\"\nlaw = \"" +
         law + R"("
youngs_modulus_pa = 6000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 0.002]]
kind = "fixed"
)";
}

}  // namespace palpate
