#include "precompute/surface/bad_faces.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "precompute/surface/self_intersections.h"

namespace palpate {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;

// A triangle at an edge, and whether it runs through it upwards in vertex numbers.
struct EdgeSide {
  std::int32_t triangle = 0;
  bool up = true;
};

class Faults {
 public:
  void add(std::int32_t triangle, FaceFault fault) {
    FaceFault& worst = fault_.try_emplace(triangle, fault).first->second;
    worst = std::max(worst, fault);
  }
  [[nodiscard]] std::vector<BadFace> list() const {
    std::vector<BadFace> faces;
    for (const auto& [triangle, fault] : fault_) {
      faces.push_back({.triangle = triangle, .fault = fault});
    }
    return faces;
  }

 private:
  std::map<std::int32_t, FaceFault> fault_;
};

void add_edge_faults(const SurfaceMesh& mesh, Faults& faults) {
  std::map<Edge, std::vector<EdgeSide>> edges;
  for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      const std::int32_t from = mesh.triangle(t, j);
      const std::int32_t to = mesh.triangle(t, (j + 1) % 3);
      edges[std::minmax(from, to)].push_back({.triangle = t, .up = from < to});
    }
  }
  for (const auto& [edge, sides] : edges) {
    const bool flipped = sides.size() == 2 && sides[0].up == sides[1].up;
    if (sides.size() == 2 && !flipped) {
      continue;
    }
    for (const EdgeSide& side : sides) {
      faults.add(side.triangle, flipped             ? FaceFault::kFlipped
                                : sides.size() == 1 ? FaceFault::kBorder
                                                    : FaceFault::kNonManifold);
    }
  }
}

void add_degenerate(const SurfaceMesh& mesh, Faults& faults) {
  for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
    const Eigen::RowVector3d p = mesh.position_m.row(mesh.triangle(t, 0));
    const Eigen::RowVector3d a = mesh.position_m.row(mesh.triangle(t, 1)) - p;
    const Eigen::RowVector3d b = mesh.position_m.row(mesh.triangle(t, 2)) - p;
    const double longest2 =
        std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    if (!(a.cross(b).norm() > 1e-10 * longest2)) {
      faults.add(t, FaceFault::kDegenerate);
    }
  }
}

std::string ply(const SurfaceMesh& mesh, const std::vector<BadFace>& faces) {
  constexpr std::array<const char*, 5> kColour{"255 220 0", "0 90 255", "255 0 255",
                                               "0 220 220", "230 0 0"};
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment lengths in metres\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty uchar fault\n"
      "property int triangle\nend_header\n",
      3 * faces.size(), faces.size());
  const auto end = std::back_inserter(text);
  for (const BadFace& face : faces) {
    for (int j = 0; j < 3; ++j) {
      const auto p = mesh.position_m.row(mesh.triangle(face.triangle, j));
      fmt::format_to(end, "{} {} {}\n", p.x(), p.y(), p.z());
    }
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto fault = static_cast<std::size_t>(faces[i].fault);
    fmt::format_to(end, "3 {} {} {} {} {} {}\n", 3 * i, 3 * i + 1, 3 * i + 2,
                   kColour[fault], fault, faces[i].triangle);
  }
  return text;
}

}  // namespace

std::vector<BadFace> bad_faces(const SurfaceMesh& mesh) {
  Faults faults;
  add_edge_faults(mesh, faults);
  add_degenerate(mesh, faults);
  for (const auto& [a, b] : self_intersections(mesh)) {
    faults.add(a, FaceFault::kSelfIntersecting);
    faults.add(b, FaceFault::kSelfIntersecting);
  }
  return faults.list();
}

void write_bad_faces(const SurfaceMesh& mesh, const std::vector<BadFace>& faces,
                     const std::filesystem::path& file) {
  if (file.extension() != ".ply") {
    throw InputError(
        fmt::format("{}: bad faces are written as .ply files only", file.string()));
  }
  AtomicFile target(file);
  std::ofstream out(target.temporary(), std::ios::binary);
  out << ply(mesh, faces);
  out.close();
  if (!out) {
    throw InputError(fmt::format("{}: cannot be written", file.string()));
  }
  target.commit();
}

}  // namespace palpate
