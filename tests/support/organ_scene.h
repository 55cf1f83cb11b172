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

/// A ball on the organ's top, so large that meshes are coarse and a build of it takes
/// less than a second; [accuracy] goes on.
inline constexpr const char* kBallOnTop = R"([[tool]]
name = "fingertip"
shape = "sphere"
radius_m = 0.06
[reach]
box_m = [[-1.0, -1.0, 0.040], [1.0, 1.0, 1.0]]
depth_max_m = 0.004
[accuracy]
force_relative = 0.3
contact_resolution = 1.0
depths = 4
)";

}  // namespace palpate
