#include "precompute/body/cut_out.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

namespace palpate {
namespace {

// Corners of the face opposite to corner j, seen from outside.
constexpr std::array<std::array<int, 3>, 4> kFace{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct Side {
  std::array<std::int32_t, 3> corner;  // ascending
  std::int32_t tet = 0;
  std::int32_t face = 0;
};

// Which tets have a corner within the radius of one of the vertices.
class Ball {
 public:
  Ball(const TetMesh& mesh, std::span<const std::int32_t> vertices, double radius_m)
      : mesh_(mesh), vertices_(vertices), radius_m_(radius_m) {}

  [[nodiscard]] bool holds(std::int32_t corner) {
    const auto [at, is_new] = known_.try_emplace(corner, false);
    if (is_new) {
      at->second = std::any_of(vertices_.begin(), vertices_.end(), [&](std::int32_t v) {
        return (mesh_.position_m.row(corner) - mesh_.position_m.row(v)).norm() <=
               radius_m_;
      });
    }
    return at->second;
  }

 private:
  const TetMesh& mesh_;
  std::span<const std::int32_t> vertices_;
  double radius_m_;
  std::unordered_map<std::int32_t, bool> known_;
};

// From tet to tet across faces that have a corner in the ball, ascending.
std::vector<std::int32_t> reached(const ConnectedTets& body,
                                  std::span<const std::int32_t> vertices,
                                  double radius_m) {
  Ball ball(body.mesh, vertices, radius_m);
  std::vector<std::int32_t> tets;
  std::unordered_set<std::int32_t> seen;
  const auto take = [&](std::int32_t t) {
    if (seen.insert(t).second) {
      tets.push_back(t);
    }
  };
  for (const std::int32_t v : vertices) {
    take(body.tet_of[static_cast<std::size_t>(v)]);
  }
  // Breadth-first over faces. A face counts if one of its corners is in a ball.
  for (std::size_t i = 0; i < tets.size(); ++i) {
    const std::int32_t t = tets[i];
    for (int j = 0; j < 4; ++j) {
      const std::int32_t next = body.across(t, j);
      const auto& face = kFace[static_cast<std::size_t>(j)];
      if (next >= 0 && std::any_of(face.begin(), face.end(), [&](int k) {
            return ball.holds(body.mesh.tet(t, k));
          })) {
        take(next);
      }
    }
  }
  std::sort(tets.begin(), tets.end());
  return tets;
}

Triangles as_triangles(const std::vector<std::array<std::int32_t, 3>>& faces) {
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      triangles(static_cast<Eigen::Index>(f), k) =
          faces[f][static_cast<std::size_t>(k)];
    }
  }
  return triangles;
}

// Corners of the body that the tets have, ascending.
std::vector<std::int32_t> corners_of_tets(const TetMesh& mesh,
                                          std::span<const std::int32_t> tets) {
  std::vector<std::int32_t> corner;
  for (const std::int32_t t : tets) {
    for (int j = 0; j < 4; ++j) {
      corner.push_back(mesh.tet(t, j));
    }
  }
  std::sort(corner.begin(), corner.end());
  corner.erase(std::unique(corner.begin(), corner.end()), corner.end());
  return corner;
}

}  // namespace

ConnectedTets connect(TetMesh mesh) {
  ConnectedTets body{.mesh = std::move(mesh), .across = {}, .tet_of = {}};
  const Tets& tet = body.mesh.tet;
  // Every tet lists its four faces by ascending corners. Sorted, the two sides of an
  // inner face follow each other; a face of the boundary stands alone.
  std::vector<Side> sides;
  sides.reserve(4 * static_cast<std::size_t>(tet.rows()));
  body.tet_of.assign(static_cast<std::size_t>(body.mesh.position_m.rows()), -1);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(tet.rows()); ++t) {
    for (std::int32_t j = 0; j < 4; ++j) {
      const auto& face = kFace[static_cast<std::size_t>(j)];
      Side side{{tet(t, face[0]), tet(t, face[1]), tet(t, face[2])}, t, j};
      std::sort(side.corner.begin(), side.corner.end());
      sides.push_back(side);
      body.tet_of[static_cast<std::size_t>(tet(t, j))] = t;
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.corner, a.tet) < std::tie(b.corner, b.tet);
  });
  body.across = Tets::Constant(tet.rows(), 4, -1);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side& a = sides[i];
    const Side& b = sides[i + 1];
    if (a.corner == b.corner) {
      body.across(a.tet, a.face) = b.tet;
      body.across(b.tet, b.face) = a.tet;
    }
  }
  return body;
}

CutOut cut_out(const ConnectedTets& body, std::span<const std::int32_t> vertices,
               double radius_m) {
  const TetMesh& mesh = body.mesh;
  const std::vector<std::int32_t> tets = reached(body, vertices, radius_m);
  CutOut part{
      .tets = {}, .surface = {}, .cut = {}, .corner = corners_of_tets(mesh, tets)};
  const auto local = [&](std::int32_t corner) {
    return static_cast<std::int32_t>(
        std::lower_bound(part.corner.begin(), part.corner.end(), corner) -
        part.corner.begin());
  };
  std::vector<std::array<std::int32_t, 3>> surface;
  std::vector<std::array<std::int32_t, 3>> cut;
  part.tets.tet.resize(static_cast<Eigen::Index>(tets.size()), 4);
  for (std::size_t i = 0; i < tets.size(); ++i) {
    const std::int32_t t = tets[i];
    const auto row = static_cast<Eigen::Index>(i);
    for (int j = 0; j < 4; ++j) {
      part.tets.tet(row, j) = local(mesh.tet(t, j));
    }
    for (int j = 0; j < 4; ++j) {
      const auto& corner = kFace[static_cast<std::size_t>(j)];
      const std::array<std::int32_t, 3> face{part.tets.tet(row, corner[0]),
                                             part.tets.tet(row, corner[1]),
                                             part.tets.tet(row, corner[2])};
      // Faces without a neighbour are of the boundary: the body's surface where all
      // corners are surface vertices. Faces to tets left out are the cut.
      const std::int32_t next = body.across(t, j);
      if (next >= 0) {
        if (!std::binary_search(tets.begin(), tets.end(), next)) {
          cut.push_back(face);
        }
      } else if (std::all_of(corner.begin(), corner.end(), [&](int k) {
                   return mesh.tet(t, k) < mesh.surface_vertices;
                 })) {
        surface.push_back(face);
      }
    }
    if (!mesh.region.empty()) {
      part.tets.region.push_back(mesh.region[static_cast<std::size_t>(t)]);
    }
  }
  part.surface = as_triangles(surface);
  part.cut = as_triangles(cut);
  part.tets.position_m.resize(static_cast<Eigen::Index>(part.corner.size()), 3);
  for (std::size_t c = 0; c < part.corner.size(); ++c) {
    part.tets.position_m.row(static_cast<Eigen::Index>(c)) =
        mesh.position_m.row(part.corner[c]);
  }
  // Corners ascend as in the body, whose surface vertices come first: here they do,
  // too.
  part.tets.surface_vertices =
      std::lower_bound(part.corner.begin(), part.corner.end(), mesh.surface_vertices) -
      part.corner.begin();
  return part;
}

}  // namespace palpate
