// A flat body that a needle punctures, in closed form.
#pragma once

#include "formats/database/response_database.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/sample_bodies.h"

namespace palpate {

inline constexpr double kPlateNeedleM = 0.0005;  // radius

// f = 2e4 e^2: the skin breaks at 2 N, 10 mm.
inline double plate_n(double e) {
  return e > 0.0 ? 2e4 * e * e : 0.0;
}

// From 10 mm on there is bone: some_puncture().
inline constexpr double kPlateBoneM = 0.010;

/// Friction of a shaft that is inserted down to the bone [N].
inline double plate_shaft_n() {
  return 15.0 * 0.002 + 40.0 * (kPlateBoneM - 0.002);
}

/// Skin, muscle and bone under all nodes of a plate of 0.1 m in z = 0.
[[nodiscard]] inline ResponseDatabase punctured_plate() {
  ResponseDatabase database = sample_database(
      plate(0.1, 10), ball(kPlateNeedleM, 0.0, 0.0),
      [](Eigen::Index /*node*/, double d) {
        return plate_n(d);
      },
      0.02, 81);
  database.tools[0].puncture = some_puncture(1);
  return database;
}

}  // namespace palpate
