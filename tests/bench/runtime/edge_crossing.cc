#include "tests/bench/runtime/edge_crossing.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Geometry>

#include "runtime/slow/memory_elements.h"

namespace palpate {
namespace {

using Eigen::Vector3d;

Vector3d vector_of(const std::array<double, 3>& values) {
  return Eigen::Map<const Vector3d>(values.data());
}

bool responds_everywhere(const Element& element) {
  return std::all_of(element.node.begin(), element.node.end(),
                     [](const ElementNode& node) {
                       return node.samples > 0;
                     });
}

}  // namespace

std::vector<EdgeCrossing> edge_crossings(const ResponseDatabase& database,
                                         const ResponseTable& table) {
  const ElementStream stream(database, table);
  std::vector<EdgeCrossing> crossings;
  for (std::int32_t t = 0; t < database.body.triangle.rows(); ++t) {
    const Element element = stream.element(t);
    for (std::size_t j = 0; j < 3 && responds_everywhere(element); ++j) {
      const std::int32_t next = element.neighbour[j];
      if (next <= t || !responds_everywhere(stream.element(next))) {
        continue;
      }
      const ElementNode& a = element.node[j];
      const ElementNode& b = element.node[(j + 1) % 3];
      const Vector3d normal = (vector_of(a.normal) + vector_of(b.normal)).normalized();
      const Vector3d edge = vector_of(b.position_m) - vector_of(a.position_m);
      crossings.push_back({t, next,
                           0.5 * (vector_of(a.position_m) + vector_of(b.position_m)),
                           normal, normal.cross(edge).normalized()});
    }
  }
  return crossings;
}

}  // namespace palpate
