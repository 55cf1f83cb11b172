#include "runtime/view_contact.h"

namespace palpate {

ViewContact view_contact(const ResponseDatabase& database, const SurfaceSearch& search,
                         const Eigen::Vector3d& x_m, std::int32_t from) {
  const SurfacePoint near = from >= 0 ? search.walk(x_m, from) : search.nearest(x_m);
  ViewContact at{.point_m = near.position_m, .triangle = near.triangle};
  for (Eigen::Index j = 0; j < 3 && near.triangle >= 0; ++j) {
    at.normal +=
        near.area_coordinate(j) *
        database.normal.row(database.body.triangle(near.triangle, j)).transpose();
  }
  at.normal.normalize();
  return at;
}

}  // namespace palpate
