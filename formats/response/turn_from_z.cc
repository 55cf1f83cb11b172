#include "formats/response/turn_from_z.h"

#include <cmath>

namespace palpate {

// Eigen's FromTwoVectors() does the same by a singular value decomposition, slow to
// compile wherever it is called.
Eigen::Quaterniond turn_from_z(const Eigen::Vector3d& along) {
  const Eigen::Vector3d axis = along.normalized();
  const double sine = std::hypot(axis.x(), axis.y());
  if (sine == 0.0) {
    return axis.z() < 0.0 ? Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)
                          : Eigen::Quaterniond::Identity();
  }
  // Of half the angle, the larger of both from the cosine, without cancellation.
  const double larger = std::sqrt(0.5 * (1.0 + std::abs(axis.z())));
  const double smaller = 0.5 * sine / larger;
  const bool acute = axis.z() >= 0.0;
  const Eigen::Vector2d across =
      (acute ? smaller : larger) / sine * Eigen::Vector2d(-axis.y(), axis.x());
  return {acute ? larger : smaller, across.x(), across.y(), 0.0};
}

}  // namespace palpate
