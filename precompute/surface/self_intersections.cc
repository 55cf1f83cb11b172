#include "precompute/surface/self_intersections.h"

#include <algorithm>
#include <array>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

namespace palpate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;

class PairTest {
 public:
  explicit PairTest(const SurfaceMesh& mesh) : mesh_(mesh) {}

  [[nodiscard]] Kernel::Point_3 point(std::int32_t vertex) const {
    return {mesh_.position_m(vertex, 0), mesh_.position_m(vertex, 1),
            mesh_.position_m(vertex, 2)};
  }

  [[nodiscard]] Kernel::Triangle_3 triangle(std::int32_t t) const {
    return {point(mesh_.triangle(t, 0)), point(mesh_.triangle(t, 1)),
            point(mesh_.triangle(t, 2))};
  }

  [[nodiscard]] bool operator()(std::int32_t a, std::int32_t b) const {
    // Corners from the shared ones on, for both.
    const auto corner_a = shared_first(a, b);
    const auto corner_b = shared_first(b, a);
    switch (corner_a.shared) {
      case 0:
        return CGAL::do_intersect(triangle(a), triangle(b));
      case 1:
        return opposite_edge_meets(corner_a.vertex, b) ||
               opposite_edge_meets(corner_b.vertex, a);
      case 2:
        return folded(corner_a.vertex, corner_b.vertex[2]);
      default:
        return true;  // the same triangle twice
    }
  }

 private:
  struct Corners {
    std::array<std::int32_t, 3> vertex{};
    int shared = 0;
  };

  [[nodiscard]] Corners shared_first(std::int32_t of, std::int32_t with) const {
    Corners corners;
    std::copy_n(mesh_.triangle.row(of).data(), 3, corners.vertex.begin());
    const auto middle = std::stable_partition(
        corners.vertex.begin(), corners.vertex.end(), [&](std::int32_t v) {
          return (mesh_.triangle.row(with).array() == v).any();
        });
    corners.shared = static_cast<int>(middle - corners.vertex.begin());
    return corners;
  }

  [[nodiscard]] bool opposite_edge_meets(const std::array<std::int32_t, 3>& corner,
                                         std::int32_t other) const {
    const Kernel::Segment_3 edge(point(corner[1]), point(corner[2]));
    return CGAL::do_intersect(edge, triangle(other));
  }

  // Two triangles at one edge overlap only if they are coplanar and on the same side.
  [[nodiscard]] bool folded(const std::array<std::int32_t, 3>& corner,
                            std::int32_t far) const {
    const Kernel::Point_3 p = point(corner[0]);
    const Kernel::Point_3 q = point(corner[1]);
    const Kernel::Point_3 r = point(corner[2]);
    return CGAL::coplanar(p, q, r, point(far)) &&
           CGAL::coplanar_orientation(p, q, r, point(far)) == CGAL::POSITIVE;
  }

  const SurfaceMesh& mesh_;
};

}  // namespace

std::vector<std::pair<std::int32_t, std::int32_t>> self_intersections(
    const SurfaceMesh& mesh) {
  const PairTest meet(mesh);
  std::vector<Box> boxes;
  for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
    const Kernel::Triangle_3 triangle = meet.triangle(t);
    if (!triangle.is_degenerate()) {
      boxes.emplace_back(triangle.bbox(), t);
    }
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  CGAL::box_self_intersection_d(
      boxes.begin(), boxes.end(), [&](const Box& one, const Box& two) {
        const std::pair pair = std::minmax({one.info(), two.info()});
        if (meet(pair.first, pair.second)) {
          pairs.emplace_back(pair.first, pair.second);
        }
      });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace palpate
