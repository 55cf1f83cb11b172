#include "precompute/tetrahedralise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <tetgen.h>

#include "formats/error.h"
#include "precompute/run_in_child.h"
#include "precompute/tetgen_failure.h"

namespace palpate {
namespace {

struct Header {
  std::int32_t code = 0;  // TetGen's, 0 for success
  std::int32_t points = 0;
  std::int32_t tets = 0;
};

void check_options(const TetOptions& options) {
  if (!(options.edge_max_m > 0.0)) {
    throw InputError(fmt::format("tetrahedra: largest edge is {} m, must be above 0",
                                 options.edge_max_m));
  }
  if (!(options.radius_edge_max >= 1.2)) {
    throw InputError(fmt::format("tetrahedra: radius-edge ratio is {}, must be >= 1.2",
                                 options.radius_edge_max));
  }
  if (!(options.time_limit_s > 0.0)) {
    throw InputError(fmt::format("tetrahedra: time limit is {} s, must be above 0",
                                 options.time_limit_s));
  }
}

void check_input(const SurfaceMesh& surface) {
  if (surface.triangle.rows() == 0 || !surface.position_m.allFinite() ||
      surface.triangle.minCoeff() < 0 ||
      surface.triangle.maxCoeff() >= surface.position_m.rows()) {
    throw InputError(fmt::format(
        "tetrahedra: a surface of {} vertices and {} triangles is empty, or "
        "has a coordinate that is not finite or an index out of range",
        surface.position_m.rows(), surface.triangle.rows()));
  }
}

// TetGen's tolerances like coordinates about 1; a power of two scales without rounding.
double scale_to_one(const SurfaceMesh& surface) {
  const double extent = bounding_box(surface).sizes().maxCoeff();
  return extent > 0.0 ? std::exp2(-std::round(std::log2(extent))) : 1.0;
}

double regular_tet_volume(double edge) {
  return edge * edge * edge / (6.0 * std::numbers::sqrt2);
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

template <typename T>
void append(std::vector<char>& bytes, const T* data, std::size_t count) {
  const auto* first = reinterpret_cast<const char*>(data);
  bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

// Runs in the child. Y: the surface is left alone; M: coplanar triangles stay apart.
std::vector<char> run_tetgen(const SurfaceMesh& surface, const TetOptions& options,
                             double scale) {
  tetgenio in;
  tetgenio out;
  fill_input(surface, scale, in);
  std::string switches = fmt::format("pYMQq{:.4f}", options.radius_edge_max);
  if (std::isfinite(options.edge_max_m)) {
    switches += fmt::format("a{:.12f}", regular_tet_volume(scale * options.edge_max_m));
  }
  Header header;
  try {
    ::tetrahedralize(switches.data(), &in, &out);
    header.points = out.numberofpoints;
    header.tets = out.numberoftetrahedra;
  } catch (int code) {
    header.code = code;
  }
  std::vector<char> bytes;
  append(bytes, &header, 1);
  append(bytes, out.pointlist, static_cast<std::size_t>(header.points) * 3);
  append(bytes, out.tetrahedronlist, static_cast<std::size_t>(header.tets) * 4);
  return bytes;
}

TetMesh unpack(const std::vector<char>& bytes, double scale) {
  Header header;
  if (bytes.size() < sizeof(header)) {
    throw NumericalError("tetrahedra: the mesher returned nothing");
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.code != 0) {
    throw NumericalError(
        fmt::format("tetrahedra: the mesher gave up: {}", tetgen_failure(header.code)));
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
  mesh.position_m /= scale;
  return mesh;
}

double tet_volume(const TetMesh& mesh, Eigen::Index t) {
  const Eigen::RowVector3d a = mesh.position_m.row(mesh.tet(t, 0));
  const Eigen::RowVector3d b = mesh.position_m.row(mesh.tet(t, 1));
  const Eigen::RowVector3d c = mesh.position_m.row(mesh.tet(t, 2));
  const Eigen::RowVector3d d = mesh.position_m.row(mesh.tet(t, 3));
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

void orient(TetMesh& mesh) {
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    if (tet_volume(mesh, t) < 0.0) {
      std::swap(mesh.tet(t, 2), mesh.tet(t, 3));
    }
  }
}

using Face = std::array<std::int32_t, 3>;

Face sorted_face(std::int32_t a, std::int32_t b, std::int32_t c) {
  Face face{a, b, c};
  std::sort(face.begin(), face.end());
  return face;
}

// Faces of one tet only, sorted: the boundary of the mesh.
std::vector<Face> boundary_faces(const Tets& tet) {
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(4 * tet.rows()));
  for (Eigen::Index t = 0; t < tet.rows(); ++t) {
    for (int j = 0; j < 4; ++j) {
      faces.push_back(sorted_face(tet(t, j), tet(t, (j + 1) % 4), tet(t, (j + 2) % 4)));
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<Face> single;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t next = i + 1;
    while (next < faces.size() && faces[next] == faces[i]) {
      ++next;
    }
    if (next == i + 1) {
      single.push_back(faces[i]);
    }
    i = next;
  }
  return single;
}

std::vector<Face> sorted_triangles(const Triangles& triangle) {
  std::vector<Face> faces;
  for (Eigen::Index t = 0; t < triangle.rows(); ++t) {
    faces.push_back(sorted_face(triangle(t, 0), triangle(t, 1), triangle(t, 2)));
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

void check_result(const SurfaceMesh& surface, const TetMesh& mesh) {
  const Eigen::Index n = surface.position_m.rows();
  if (mesh.position_m.rows() < n || mesh.position_m.topRows(n) != surface.position_m) {
    throw NumericalError("tetrahedra: the mesher moved or dropped surface vertices");
  }
  if (mesh.tet.minCoeff() < 0 || mesh.tet.maxCoeff() >= mesh.position_m.rows()) {
    throw NumericalError("tetrahedra: the mesher returned an index out of range");
  }
  const TetQuality quality = tet_quality(mesh);
  if (!(quality.smallest_volume_m3 > 0.0)) {
    throw NumericalError(fmt::format("tetrahedra: the smallest has a volume of {} m^3",
                                     quality.smallest_volume_m3));
  }
  const double volume_m3 = enclosed_volume_m3(surface);
  if (!(std::abs(quality.volume_m3 - volume_m3) <= 1e-9 * volume_m3)) {
    throw NumericalError(
        fmt::format("tetrahedra: they fill {} m^3, the surface encloses {} m^3",
                    quality.volume_m3, volume_m3));
  }
  if (boundary_faces(mesh.tet) != sorted_triangles(surface.triangle)) {
    throw NumericalError("tetrahedra: their boundary is not the surface's triangles");
  }
}

}  // namespace

double estimated_tets(const SurfaceMesh& surface, const TetOptions& options) {
  // Graded: three tets per surface triangle, measured on bodies of 300 to 100,000
  // triangles. Uniform inside: the volume over that of a tet, which TetGen makes at
  // about half the allowed volume.
  const double graded = 3.0 * static_cast<double>(surface.triangle.rows());
  return graded + std::abs(enclosed_volume_m3(surface)) /
                      (0.5 * regular_tet_volume(options.edge_max_m));
}

TetMesh tetrahedralise(const SurfaceMesh& surface, const TetOptions& options) {
  check_options(options);
  check_input(surface);
  const double estimate = estimated_tets(surface, options);
  if (!(estimate <= static_cast<double>(options.tets_max))) {
    throw InputError(
        fmt::format("tetrahedra: about {:.3g} would be needed, {} are allowed: is the "
                    "length unit right, and a largest edge of {} m meant?",
                    estimate, options.tets_max, options.edge_max_m));
  }
  const double scale = scale_to_one(surface);
  const ChildResult result = run_in_child(
      [&] {
        return run_tetgen(surface, options, scale);
      },
      {.time_s = options.time_limit_s, .memory_bytes = options.memory_limit_bytes});
  if (!result.done) {
    throw NumericalError(
        fmt::format("tetrahedra: the mesher failed: {}", result.failure));
  }
  TetMesh mesh = unpack(result.bytes, scale);
  mesh.surface_vertices = surface.position_m.rows();
  orient(mesh);
  check_result(surface, mesh);
  return mesh;
}

TetQuality tet_quality(const TetMesh& mesh) {
  TetQuality quality{.smallest_volume_m3 = std::numeric_limits<double>::infinity(),
                     .smallest_dihedral_rad = std::numbers::pi};
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    const double volume_m3 = tet_volume(mesh, t);
    quality.volume_m3 += volume_m3;
    quality.smallest_volume_m3 = std::min(quality.smallest_volume_m3, volume_m3);
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        // Angle between the two faces at edge (i, j), from their parts across it.
        const int k = i != 0 && j != 0 ? 0 : (i != 1 && j != 1 ? 1 : 2);
        const int l = 6 - i - j - k;
        const Eigen::Vector3d p = mesh.position_m.row(mesh.tet(t, i)).transpose();
        const Eigen::Vector3d edge =
            mesh.position_m.row(mesh.tet(t, j)).transpose() - p;
        const Eigen::Vector3d u =
            edge.cross(mesh.position_m.row(mesh.tet(t, k)).transpose() - p);
        const Eigen::Vector3d v =
            edge.cross(mesh.position_m.row(mesh.tet(t, l)).transpose() - p);
        const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
        quality.smallest_dihedral_rad = std::min(quality.smallest_dihedral_rad, angle);
        quality.largest_dihedral_rad = std::max(quality.largest_dihedral_rad, angle);
      }
    }
  }
  return quality;
}

}  // namespace palpate
