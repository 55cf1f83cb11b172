#include "precompute/tets/tetgen_run.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <tetgen.h>

#include "formats/base/error.h"
#include "precompute/process/packed_bytes.h"
#include "precompute/tets/tetgen_failure.h"

namespace palpate {
namespace {

struct Header {
  std::int32_t code = 0;  // TetGen's, 0 for success
  std::int32_t points = 0;
  std::int32_t tets = 0;
};

constexpr int kTooMany = 100;  // beside TetGen's own codes

struct Task {
  TetOptions options;
  double scale = 1.0;
  TetTry how;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
};

// TetGen's callback has no argument for these. Only ever set in a child process of
// one thread.
struct SizeFunction {
  Task task;
  std::int64_t cuts = 0;
};
SizeFunction g_size;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

// Whether a tet is larger than the regular one of the wanted edge at its centre.
bool too_large(REAL* pa, REAL* pb, REAL* pc, REAL* pd, REAL* /*angles*/, REAL /*v*/) {
  using Point = Eigen::Map<const Eigen::Vector3d>;
  const Eigen::Vector3d a = Point(pa);
  const Eigen::Vector3d b = Point(pb);
  const Eigen::Vector3d c = Point(pc);
  const Eigen::Vector3d d = Point(pd);
  const auto& [options, scale, how, vertices, triangles] = g_size.task;
  const double volume = std::abs((b - a).cross(c - a).dot(d - a)) / 6.0;
  const double edge_m =
      options.size((a + b + c + d) / (4.0 * scale), options.size_parameter);
  if (!(volume > regular_tet_volume(scale * edge_m))) {
    return false;
  }
  // Each cut is a new vertex, and a vertex makes about six tets.
  if (6 * ++g_size.cuts > options.tets_max) {
    throw kTooMany;
  }
  return true;
}

void fill_input(const SurfaceMesh& surface, double scale, tetgenio& in) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(surface.position_m.rows());
  in.pointlist = new REAL[static_cast<std::size_t>(surface.position_m.size())];
  Eigen::Map<Points>(in.pointlist, surface.position_m.rows(), 3) =
      scale * surface.position_m;
  in.numberoffacets = static_cast<int>(surface.triangle.rows());
  in.facetlist = new tetgenio::facet[static_cast<std::size_t>(in.numberoffacets)];
  for (int t = 0; t < in.numberoffacets; ++t) {
    tetgenio::facet& facet = in.facetlist[t];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::polygon& polygon = facet.polygonlist[0];
    tetgenio::init(&polygon);
    polygon.numberofvertices = 3;
    polygon.vertexlist = new int[3];
    std::copy_n(surface.triangle.row(t).data(), 3, polygon.vertexlist);
  }
}

// Y: the surfaces are left alone; M: coplanar triangles stay apart. Dihedral angles
// below 8 degrees are refined and above 130 swapped away, as far as the surface lets
// them. No O for more levels of swapping: it gains nothing and never ends on needles.
std::string switches(const Task& task) {
  std::string text = "pYMQ";
  if (task.how.graded) {
    text += fmt::format("q{:.4f}", task.options.radius_edge_max);
  }
  if (task.how.graded && task.how.improved) {
    text += "/8o/130";
  }
  if (std::isfinite(task.options.edge_max_m)) {
    text += fmt::format("a{:.12f}",
                        regular_tet_volume(task.scale * task.options.edge_max_m));
  }
  return text;
}

// Pseudo-random in [-1, 1], the same for the same index (Steele, Lea and Flood 2014).
double noise(std::uint64_t index) {
  std::uint64_t x = index + 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1.0p-52 - 1.0;
}

void move(double by, tetgenio& in) {
  for (int i = 0; by > 0.0 && i < 3 * in.numberofpoints; ++i) {
    in.pointlist[i] += by * noise(static_cast<std::uint64_t>(i));
  }
}

void orient(TetMesh& mesh) {
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    if (tet_volume_m3(mesh, t) < 0.0) {
      std::swap(mesh.tet(t, 2), mesh.tet(t, 3));
    }
  }
}

}  // namespace

double regular_tet_volume(double edge) {
  return edge * edge * edge / (6.0 * std::numbers::sqrt2);
}

std::vector<char> tetgen_input(const SurfaceMesh& surface, const TetOptions& options,
                               double scale, const TetTry& how) {
  const Task task{.options = options,
                  .scale = scale,
                  .how = how,
                  .vertices = static_cast<std::size_t>(surface.position_m.rows()),
                  .triangles = static_cast<std::size_t>(surface.triangle.rows())};
  std::vector<char> bytes;
  append_bytes(bytes, &task, 1);
  append_bytes(bytes, surface.position_m.data(), 3 * task.vertices);
  append_bytes(bytes, surface.triangle.data(), 3 * task.triangles);
  return bytes;
}

std::vector<char> tetgen_run(std::span<const char> input) {
  // Runs in a child process: TetGen may crash or exit. Input and output are plain
  // bytes.
  Task task;
  take_bytes(input, &task, 1);
  SurfaceMesh surface;
  surface.position_m.resize(static_cast<Eigen::Index>(task.vertices), 3);
  surface.triangle.resize(static_cast<Eigen::Index>(task.triangles), 3);
  take_bytes(input, surface.position_m.data(), 3 * task.vertices);
  take_bytes(input, surface.triangle.data(), 3 * task.triangles);
  tetgenio in;
  tetgenio out;
  fill_input(surface, task.scale, in);
  move(task.how.moved, in);
  if (task.options.size != nullptr) {
    g_size = {.task = task};
    in.tetunsuitable = &too_large;
  }
  std::string text = switches(task);
  Header header;
  try {
    ::tetrahedralize(text.data(), &in, &out);
    header.points = out.numberofpoints;
    header.tets = out.numberoftetrahedra;
  } catch (int code) {
    header.code = code;
  }
  std::vector<char> bytes;
  append_bytes(bytes, &header, 1);
  append_bytes(bytes, out.pointlist, static_cast<std::size_t>(header.points) * 3);
  append_bytes(bytes, out.tetrahedronlist, static_cast<std::size_t>(header.tets) * 4);
  return bytes;
}

TetMesh tetgen_unpack(std::span<const char> bytes, const TetOptions& options,
                      double scale) {
  Header header;
  take_bytes(bytes, &header, 1);
  if (header.code == kTooMany) {
    throw InputError(
        fmt::format("tetrahedra: the wanted sizes need more than the {} allowed",
                    options.tets_max));
  }
  constexpr int kMemory = 1;
  constexpr int kCrossing = 3;
  const std::string gave_up =
      fmt::format("tetrahedra: the mesher gave up: {}", tetgen_failure(header.code));
  if (header.code == kMemory || header.code == kCrossing) {
    throw HopelessTry(gave_up);
  }
  if (header.code != 0) {
    throw NumericalError(gave_up);
  }
  if (header.tets == 0) {
    throw NumericalError("tetrahedra: the mesher returned no tetrahedra");
  }
  TetMesh mesh;
  mesh.position_m.resize(header.points, 3);
  mesh.tet.resize(header.tets, 4);
  take_bytes(bytes, mesh.position_m.data(),
             static_cast<std::size_t>(header.points) * 3);
  take_bytes(bytes, mesh.tet.data(), static_cast<std::size_t>(header.tets) * 4);
  if (mesh.tet.minCoeff() < 0 || mesh.tet.maxCoeff() >= mesh.position_m.rows()) {
    throw NumericalError("tetrahedra: the mesher returned an index out of range");
  }
  mesh.position_m /= scale;
  orient(mesh);
  return mesh;
}

}  // namespace palpate
