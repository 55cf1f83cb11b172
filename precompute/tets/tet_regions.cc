#include "precompute/tets/tet_regions.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/surface/disjoint_sets.h"

namespace palpate {
namespace {

using Corners = std::array<std::int32_t, 3>;

// A face with its corners ascending; `even`: that is an even permutation of its
// counter-clockwise corners. `from`: the tet, or the triangle among those of all
// surfaces, whose face it is.
struct Face {
  Corners corner{};
  bool even = true;
  std::int32_t from = 0;
};

Face make_face(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t from) {
  Face face{.corner = {a, b, c}, .even = true, .from = from};
  Corners& v = face.corner;
  for (const auto& [i, j] :
       {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 1}}) {
    if (v[i] > v[j]) {
      std::swap(v[i], v[j]);
      face.even = !face.even;
    }
  }
  return face;
}

bool before(const Face& a, const Face& b) {
  return std::tie(a.corner, a.from) < std::tie(b.corner, b.from);
}

// Faces of positive tets, counter-clockwise from outside the tet.
std::vector<Face> tet_faces(const Tets& tet) {
  static constexpr std::array<std::array<int, 3>, 4> kOutward{
      {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(4 * tet.rows()));
  for (Eigen::Index t = 0; t < tet.rows(); ++t) {
    for (const auto& [a, b, c] : kOutward) {
      faces.push_back(
          make_face(tet(t, a), tet(t, b), tet(t, c), static_cast<std::int32_t>(t)));
    }
  }
  std::sort(faces.begin(), faces.end(), before);
  return faces;
}

std::vector<Face> surface_faces(std::span<const Triangles> inner) {
  std::vector<Face> faces;
  std::int32_t from = 0;
  for (const Triangles& triangle : inner) {
    for (Eigen::Index t = 0; t < triangle.rows(); ++t) {
      faces.push_back(
          make_face(triangle(t, 0), triangle(t, 1), triangle(t, 2), from++));
    }
  }
  std::sort(faces.begin(), faces.end(), before);
  return faces;
}

// Number of the surface that each of all triangles belongs to.
std::vector<std::int32_t> surface_of_triangle(std::span<const Triangles> inner) {
  std::vector<std::int32_t> surface;
  for (std::size_t i = 0; i < inner.size(); ++i) {
    surface.insert(surface.end(), static_cast<std::size_t>(inner[i].rows()),
                   static_cast<std::int32_t>(i));
  }
  return surface;
}

// Sets of tets that no surface parts, and the surface that each is known to be in.
class Sets {
 public:
  Sets(std::size_t tets, std::span<const Triangles> inner)
      : tets_(tets),
        set_(tets),
        surface_(surface_of_triangle(inner)),
        outside_(surface_.size(), 0) {}

  void pass(const Face& one, const Face& two) { set_.join(one.from, two.from); }

  // The tet whose face runs as the triangle does lies behind it.
  void part(const Face& one, const Face& two, const Face& triangle) {
    const bool one_behind = one.even == triangle.even;
    const auto t = static_cast<std::size_t>(triangle.from);
    inside_.emplace_back((one_behind ? one : two).from, surface_[t]);
    outside_[t] = (one_behind ? two : one).from;
  }

  [[nodiscard]] TetRegions regions() {
    std::map<std::int32_t, std::int32_t> surface_of;
    for (const auto& [tet, surface] : inside_) {
      const auto [at, inserted] = surface_of.try_emplace(set_.find(tet), surface);
      if (at->second != surface) {
        throw NumericalError(fmt::format(
            "tetrahedra: a region is inside of inner surface {} and of {} at once",
            at->second + 1, surface + 1));
      }
    }
    TetRegions result;
    for (std::size_t t = 0; t < tets_; ++t) {
      const auto at = surface_of.find(set_.find(static_cast<std::int32_t>(t)));
      result.region.push_back(at == surface_of.end() ? 0 : at->second + 1);
    }
    for (const std::int32_t tet : outside_) {
      result.around.push_back(result.region[static_cast<std::size_t>(tet)]);
    }
    return result;
  }

 private:
  std::size_t tets_;
  Partition set_;
  std::vector<std::int32_t> surface_;  // by triangle
  std::vector<std::int32_t> outside_;  // by triangle: the tet before it
  std::vector<std::pair<std::int32_t, std::int32_t>> inside_;  // tet, surface
};

Triangles triangles_of(const std::vector<Face>& faces) {
  Triangles triangle(std::ssize(faces), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    std::copy_n(faces[i].corner.data(), 3,
                triangle.row(static_cast<Eigen::Index>(i)).data());
  }
  return triangle;
}

}  // namespace

TetRegions tet_regions(const Tets& tet, std::span<const Triangles> inner) {
  const auto tets = static_cast<std::size_t>(tet.rows());
  const std::vector<Face> wall = surface_faces(inner);
  if (wall.empty()) {
    return {.region = std::vector<std::int32_t>(tets, 0), .around = {}};
  }
  // Faces of tets and of walls are sorted alike and walked together. A face of two tets
  // joins their sets, unless a wall lies on it.
  const std::vector<Face> faces = tet_faces(tet);
  Sets sets(tets, inner);
  auto next_wall = wall.begin();
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].corner != faces[i + 1].corner) {
      continue;
    }
    if (next_wall != wall.end() && next_wall->corner == faces[i].corner) {
      sets.part(faces[i], faces[i + 1], *next_wall++);
    } else {
      sets.pass(faces[i], faces[i + 1]);
    }
  }
  if (next_wall != wall.end()) {
    throw NumericalError(
        fmt::format("tetrahedra: triangle ({}, {}, {}) of an inner surface is not a "
                    "face between two of them",
                    next_wall->corner[0], next_wall->corner[1], next_wall->corner[2]));
  }
  return sets.regions();
}

Triangles boundary_faces(const Tets& tet) {
  const std::vector<Face> faces = tet_faces(tet);
  std::vector<Face> single;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t next = i + 1;
    while (next < faces.size() && faces[next].corner == faces[i].corner) {
      ++next;
    }
    if (next == i + 1) {
      single.push_back(faces[i]);
    }
    i = next;
  }
  return triangles_of(single);
}

Triangles sorted_faces(const Triangles& triangle) {
  return triangles_of(surface_faces({&triangle, 1}));
}

void remove_regions(std::span<const bool> hollow, Eigen::Index kept_vertices,
                    TetMesh& mesh) {
  // Tets of hollow regions go; so do vertices that no tet uses, but for the first ones.
  Eigen::Index tets = 0;
  std::vector<bool> used(static_cast<std::size_t>(mesh.position_m.rows()), false);
  std::fill_n(used.begin(), kept_vertices, true);
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    const std::int32_t region = mesh.region[static_cast<std::size_t>(t)];
    if (!hollow[static_cast<std::size_t>(region)]) {
      for (const std::int32_t v : mesh.tet.row(t)) {
        used[static_cast<std::size_t>(v)] = true;
      }
      mesh.tet.row(tets) = mesh.tet.row(t).eval();
      mesh.region[static_cast<std::size_t>(tets++)] = region;
    }
  }
  mesh.tet.conservativeResize(tets, 4);
  mesh.region.resize(static_cast<std::size_t>(tets));
  std::vector<std::int32_t> number(used.size(), -1);
  std::int32_t vertices = 0;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) {
      mesh.position_m.row(vertices) =
          mesh.position_m.row(static_cast<Eigen::Index>(v)).eval();
      number[v] = vertices++;
    }
  }
  mesh.position_m.conservativeResize(vertices, 3);
  for (std::int32_t& v : mesh.tet.reshaped()) {
    v = number[static_cast<std::size_t>(v)];
  }
}

}  // namespace palpate
