#include "precompute/tets/tetgen_run.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <tetgen.h>

#include "formats/base/error.h"
#include "precompute/tets/tetgen_failure.h"

namespace palpate {
namespace {

struct Header {
  std::int32_t code = 0;  // TetGen's, 0 for success
  std::int32_t points = 0;
  std::int32_t tets = 0;
};

constexpr int kTooMany = 100;  // beside TetGen's own codes

// TetGen's callback has no argument for these. Only ever set in a child process of
// one thread.
struct SizeFunction {
  const TetOptions* options = nullptr;
  double scale = 1.0;
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
  const double volume = std::abs((b - a).cross(c - a).dot(d - a)) / 6.0;
  const double edge_m = g_size.options->size((a + b + c + d) / (4.0 * g_size.scale));
  if (!(volume > regular_tet_volume(g_size.scale * edge_m))) {
    return false;
  }
  // Each cut is a new vertex, and a vertex makes about six tets.
  if (6 * ++g_size.cuts > g_size.options->tets_max) {
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
std::string switches(const TetOptions& options, double scale, const TetTry& how) {
  std::string text = "pYMQ";
  if (how.graded) {
    text += fmt::format("q{:.4f}", options.radius_edge_max);
  }
  if (how.graded && how.improved) {
    text += "/8o/130";
  }
  if (std::isfinite(options.edge_max_m)) {
    text += fmt::format("a{:.12f}", regular_tet_volume(scale * options.edge_max_m));
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

template <typename T>
void append_bytes(std::vector<char>& bytes, const T* data, std::size_t count) {
  const auto* first = reinterpret_cast<const char*>(data);
  bytes.insert(bytes.end(), first, first + count * sizeof(T));
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

std::vector<char> tetgen_run(const SurfaceMesh& surface, const TetOptions& options,
                             double scale, const TetTry& how) {
  tetgenio in;
  tetgenio out;
  fill_input(surface, scale, in);
  move(how.moved, in);
  if (options.size) {
    g_size = {.options = &options, .scale = scale};
    in.tetunsuitable = &too_large;
  }
  std::string text = switches(options, scale, how);
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

TetMesh tetgen_unpack(const std::vector<char>& bytes, const TetOptions& options,
                      double scale) {
  Header header;
  if (bytes.size() < sizeof(header)) {
    throw NumericalError("tetrahedra: the mesher returned nothing");
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
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
  const std::size_t point_bytes = static_cast<std::size_t>(header.points) * 3 * 8;
  const std::size_t tet_bytes = static_cast<std::size_t>(header.tets) * 4 * 4;
  if (bytes.size() != sizeof(header) + point_bytes + tet_bytes || header.tets == 0) {
    throw NumericalError("tetrahedra: the mesher returned no tetrahedra");
  }
  TetMesh mesh;
  mesh.position_m.resize(header.points, 3);
  mesh.tet.resize(header.tets, 4);
  std::memcpy(mesh.position_m.data(), bytes.data() + sizeof(header), point_bytes);
  std::memcpy(mesh.tet.data(), bytes.data() + sizeof(header) + point_bytes, tet_bytes);
  if (mesh.tet.minCoeff() < 0 || mesh.tet.maxCoeff() >= mesh.position_m.rows()) {
    throw NumericalError("tetrahedra: the mesher returned an index out of range");
  }
  mesh.position_m /= scale;
  orient(mesh);
  return mesh;
}

}  // namespace palpate
