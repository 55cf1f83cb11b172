#include "precompute/tets/cut_tets.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "formats/base/at.h"

namespace palpate {
namespace {

// FourCorners of the face opposite to corner j.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaceOfTet{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
constexpr std::array<std::array<int, 2>, 6> kEdgeOfTet{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// [-] of an edge: a wall closer to its end goes through that.
constexpr double kMoved = 0.1;
constexpr double kUnmoved = 0.02;
// [-] of a tet's volume that has to be left when a vertex of it is moved.
constexpr double kVolumeLeft = 0.2;

using FourCorners = std::array<std::int32_t, 4>;

// A convex polygon as triangles about its vertex of the lowest number.
std::vector<std::array<std::int32_t, 3>> fan(std::vector<std::int32_t> loop) {
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    triangles.push_back({loop[0], loop[i], loop[i + 1]});
  }
  return triangles;
}

Tets as_tets(const std::vector<FourCorners>& rows) {
  Tets tets(std::ssize(rows), 4);
  for (std::size_t t = 0; t < rows.size(); ++t) {
    std::copy_n(rows[t].data(), 4, tets.row(static_cast<Eigen::Index>(t)).data());
  }
  return tets;
}

}  // namespace

CutTets::CutTets(TetMesh tets, Triangles surface, Eigen::Index fixed)
    : mesh_(std::move(tets)),
      surface_(std::move(surface)),
      fixed_(at(mesh_.position_m.rows()), false) {
  std::fill_n(fixed_.begin(), fixed, true);
}

Eigen::Vector3d CutTets::vertex_m(std::int32_t v) const {
  return mesh_.position_m.row(v).transpose();
}

void CutTets::find_crossings(const In& in_part) {
  constexpr int kHalvings = 30;
  // 1. The side of each vertex: 1 in the part, -1 outside.
  side_.clear();
  for (std::int32_t v = 0; v < mesh_.position_m.rows(); ++v) {
    side_.push_back(in_part(vertex_m(v)) ? 1 : -1);
  }
  // 2. Edges whose ends differ, each once.
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (Eigen::Index t = 0; t < mesh_.tet.rows(); ++t) {
    for (const auto& [i, j] : kEdgeOfTet) {
      const std::int32_t a = mesh_.tet(t, i);
      const std::int32_t b = mesh_.tet(t, j);
      if (side_[at(a)] != side_[at(b)]) {
        edges.emplace_back(std::min(a, b), std::max(a, b));
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  // 3. Where the wall crosses each, by bisection to 2^-31 of the edge. An edge that the
  //    wall crosses several times has one of the crossings.
  crossing_.clear();
  for (const auto& [a, b] : edges) {
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      const bool in = in_part(vertex_m(a) + middle * (vertex_m(b) - vertex_m(a)));
      (in == (side_[at(a)] > 0) ? low : high) = middle;
    }
    crossing_.push_back({a, b, 0.5 * (low + high), -1});
  }
}

bool CutTets::may_move(std::int32_t v, const Eigen::Vector3d& to_m) const {
  return std::all_of(around_[at(v)].begin(), around_[at(v)].end(), [&](std::int32_t t) {
    std::array<Eigen::Vector3d, 4> p;
    for (std::size_t j = 0; j < 4; ++j) {
      const std::int32_t corner = mesh_.tet(t, static_cast<Eigen::Index>(j));
      p[j] = corner == v ? to_m : vertex_m(corner);
    }
    const double volume_m3 = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) / 6;
    return volume_m3 > kVolumeLeft * tet_volume_m3(mesh_, t);
  });
}

void CutTets::move_onto_wall() {
  struct Nearest {
    double share = std::numeric_limits<double>::infinity();
    Eigen::Vector3d wall_m = Eigen::Vector3d::Zero();
  };
  // The crossing nearest to each vertex, in shares of its edge.
  std::vector<Nearest> nearest(side_.size());
  for (const Crossing& one : crossing_) {
    const Eigen::Vector3d wall_m =
        vertex_m(one.a) + one.share * (vertex_m(one.b) - vertex_m(one.a));
    for (const auto& [v, share] :
         {std::pair{one.a, one.share}, std::pair{one.b, 1.0 - one.share}}) {
      if (share < nearest[at(v)].share) {
        nearest[at(v)] = {share, wall_m};
      }
    }
  }
  around_.assign(side_.size(), {});
  for (std::int32_t t = 0; t < mesh_.tet.rows(); ++t) {
    for (const std::int32_t v : mesh_.tet.row(t)) {
      around_[at(v)].push_back(t);
    }
  }
  for (std::int32_t v = 0; v < std::ssize(side_); ++v) {
    // A vertex close to the wall moves onto the wall, unless a tet would become too
    // flat: thin slivers are not cut off. One that may not move counts as on the wall
    // if very close.
    const Nearest& to = nearest[at(v)];
    if (!fixed_[at(v)] && to.share < kMoved && may_move(v, to.wall_m)) {
      mesh_.position_m.row(v) = to.wall_m.transpose();
      side_[at(v)] = 0;
    } else if (to.share < kUnmoved) {
      side_[at(v)] = 0;
    }
  }
}

void CutTets::add_vertices() {
  const auto gone =
      std::remove_if(crossing_.begin(), crossing_.end(), [&](const Crossing& one) {
        return side_[at(one.a)] * side_[at(one.b)] == 0;
      });
  crossing_.erase(gone, crossing_.end());
  auto next = static_cast<std::int32_t>(mesh_.position_m.rows());
  mesh_.position_m.conservativeResize(next + std::ssize(crossing_), 3);
  for (Crossing& one : crossing_) {
    one.vertex = next++;
    mesh_.position_m.row(one.vertex) =
        (vertex_m(one.a) + one.share * (vertex_m(one.b) - vertex_m(one.a))).transpose();
  }
  fixed_.resize(at(next), true);
  side_.resize(at(next), 0);
}

std::int32_t CutTets::cut_between(std::int32_t a, std::int32_t b) const {
  const auto wanted = std::minmax(a, b);
  return std::lower_bound(
             crossing_.begin(), crossing_.end(), wanted,
             [](const Crossing& one, const auto& edge) {
               return std::pair{one.a, one.b} < std::pair{edge.first, edge.second};
             })
      ->vertex;
}

// What of a triangle is on one side.
CutTets::Loop CutTets::part_of(std::int32_t a, std::int32_t b, std::int32_t c,
                               int side) const {
  const std::array<std::int32_t, 3> corner{a, b, c};
  Loop loop;
  for (std::size_t j = 0; j < 3; ++j) {
    const std::int32_t from = corner[j];
    const std::int32_t to = corner[(j + 1) % 3];
    if (side_[at(from)] != -side) {
      loop.push_back(from);
    }
    if (side_[at(from)] * side_[at(to)] < 0) {
      loop.push_back(cut_between(from, to));
    }
  }
  return loop;
}

// The wall in a tet that has corners on both sides.
CutTets::Loop CutTets::wall_in(const std::int32_t* corner) const {
  Loop in;
  Loop out;
  Loop loop;
  for (const std::int32_t v : std::span(corner, 4)) {
    (side_[at(v)] > 0 ? in : side_[at(v)] < 0 ? out : loop).push_back(v);
  }
  if (in.size() == 2 && out.size() == 2) {
    return {cut_between(in[0], out[0]), cut_between(in[0], out[1]),
            cut_between(in[1], out[1]), cut_between(in[1], out[0])};
  }
  for (const std::int32_t a : in) {
    for (const std::int32_t b : out) {
      loop.push_back(cut_between(a, b));
    }
  }
  return loop;
}

std::vector<FourCorners> CutTets::piece_of(const std::int32_t* corner, int side) const {
  // The piece is a convex polyhedron: the wall, and what of each face is on the side.
  std::vector<Loop> faces{wall_in(corner)};
  for (const auto& [a, b, c] : kFaceOfTet) {
    Loop face = part_of(corner[a], corner[b], corner[c], side);
    if (face.size() >= 3) {
      faces.push_back(std::move(face));
    }
  }
  // Its tets are pyramids over the triangles of faces without the apex. The apex and
  // fans begin at the lowest number, so that neighbours cut their common face alike.
  std::int32_t apex = std::numeric_limits<std::int32_t>::max();
  for (const Loop& face : faces) {
    apex = std::min(apex, *std::min_element(face.begin(), face.end()));
  }
  std::vector<FourCorners> tets;
  for (const Loop& face : faces) {
    if (std::find(face.begin(), face.end(), apex) != face.end()) {
      continue;
    }
    for (const auto& [a, b, c] : fan(face)) {
      const Eigen::Vector3d p = vertex_m(apex);
      const double volume =
          (vertex_m(a) - p).cross(vertex_m(b) - p).dot(vertex_m(c) - p);
      tets.push_back(volume > 0.0 ? FourCorners{apex, a, b, c}
                                  : FourCorners{apex, b, a, c});
    }
  }
  return tets;
}

void CutTets::cut_tets(const In& in_part, std::int32_t region,
                       const std::function<bool(std::int32_t)>& may_take) {
  std::vector<FourCorners> tets;
  std::vector<std::int32_t> regions;
  for (Eigen::Index t = 0; t < mesh_.tet.rows(); ++t) {
    const std::int32_t* corner = mesh_.tet.row(t).data();
    const auto has = [&](int side) {
      return std::any_of(corner, corner + 4, [&](std::int32_t v) {
        return side_[at(v)] == side;
      });
    };
    const std::int32_t before = mesh_.region[at(t)];
    const std::int32_t inside = may_take(before) ? region : before;
    if (has(1) && has(-1)) {
      for (const int side : {1, -1}) {
        for (const FourCorners& piece : piece_of(corner, side)) {
          tets.push_back(piece);
          regions.push_back(side > 0 ? inside : before);
        }
      }
      continue;
    }
    // One with all of its corners on the wall goes by its middle.
    const bool in =
        has(1) ||
        (!has(-1) && in_part(0.25 * (vertex_m(corner[0]) + vertex_m(corner[1]) +
                                     vertex_m(corner[2]) + vertex_m(corner[3]))));
    tets.push_back({corner[0], corner[1], corner[2], corner[3]});
    regions.push_back(in ? inside : before);
  }
  mesh_.tet = as_tets(tets);
  mesh_.region = std::move(regions);
}

void CutTets::cut_surface() {
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (Eigen::Index t = 0; t < surface_.rows(); ++t) {
    const std::int32_t* corner = surface_.row(t).data();
    const auto has = [&](int side) {
      return std::any_of(corner, corner + 3, [&](std::int32_t v) {
        return side_[at(v)] == side;
      });
    };
    if (!has(1) || !has(-1)) {
      triangles.push_back({corner[0], corner[1], corner[2]});
      continue;
    }
    // Fans as in piece_of(), so that the triangles stay faces of the tets.
    for (const int side : {1, -1}) {
      for (const auto& one : fan(part_of(corner[0], corner[1], corner[2], side))) {
        triangles.push_back(one);
      }
    }
  }
  surface_.resize(std::ssize(triangles), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::copy_n(triangles[t].data(), 3,
                surface_.row(static_cast<Eigen::Index>(t)).data());
  }
}

void CutTets::along(const In& in_part, std::int32_t region,
                    const std::function<bool(std::int32_t)>& may_take) {
  find_crossings(in_part);
  move_onto_wall();
  add_vertices();
  cut_tets(in_part, region, may_take);
  cut_surface();
}

FilledBody CutTets::take() {
  const auto vertices = static_cast<std::int32_t>(mesh_.position_m.rows());
  const auto old = static_cast<std::int32_t>(mesh_.surface_vertices);
  // Surface vertices come first: those from before keep their order, new ones follow.
  std::vector<bool> on_surface(at(vertices), false);
  std::fill_n(on_surface.begin(), old, true);
  for (const std::int32_t v : surface_.reshaped()) {
    on_surface[at(v)] = true;
  }
  std::vector<std::int32_t> number(at(vertices), -1);
  Points position_m(vertices, 3);
  std::int32_t next = 0;
  for (const bool wanted : {true, false}) {
    for (std::int32_t v = 0; v < vertices; ++v) {
      if (on_surface[at(v)] == wanted) {
        position_m.row(next) = mesh_.position_m.row(v);
        number[at(v)] = next++;
      }
    }
    mesh_.surface_vertices = wanted ? next : mesh_.surface_vertices;
  }
  mesh_.position_m = std::move(position_m);
  for (std::int32_t& v : mesh_.tet.reshaped()) {
    v = number[at(v)];
  }
  for (std::int32_t& v : surface_.reshaped()) {
    v = number[at(v)];
  }
  return {.surface = {.position_m = mesh_.position_m.topRows(mesh_.surface_vertices),
                      .triangle = std::move(surface_)},
          .tets = std::move(mesh_)};
}

}  // namespace palpate
