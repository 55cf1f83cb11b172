#include "precompute/tets/tetrahedralise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/run_in_child.h"
#include "precompute/surface/surface_check.h"
#include "precompute/surface/surface_parts.h"
#include "precompute/surface/winding_number.h"
#include "precompute/tets/tet_regions.h"
#include "precompute/tets/tetgen_run.h"

namespace palpate {
namespace {

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

void check_estimate(const SurfaceMesh& surface, const TetOptions& options) {
  const double estimate = estimated_tets(surface, options);
  if (!(estimate <= static_cast<double>(options.tets_max))) {
    throw InputError(
        fmt::format("tetrahedra: about {:.3g} would be needed, {} are allowed: is the "
                    "length unit right, and a largest edge of {} m meant?",
                    estimate, options.tets_max, options.edge_max_m));
  }
}

// TetGen's tolerances like coordinates about 1; a power of two scales without rounding.
double scale_to_one(const SurfaceMesh& surface) {
  int exponent = 0;
  const double mantissa =
      std::frexp(bounding_box(surface).sizes().maxCoeff(), &exponent);
  return std::ldexp(1.0,
                    mantissa < 0.5 * std::numbers::sqrt2 ? 1 - exponent : -exponent);
}

// The outer and the inner surfaces as the mesher takes them, and as they come back.
struct Walls {
  SurfaceMesh all;
  std::vector<Triangles> inner;     // in the vertex numbers of all; then the islands
  std::size_t islands = 0;          // parts of the body that lie in its cavities
  std::unique_ptr<bool[]> hollow;   // by region
  std::vector<std::string> region;  // names
};

// Parts of the surface that lie in a cavity.
std::vector<SurfacePart> parts_in_cavities(const SurfaceMesh& surface,
                                           std::span<const InnerSurface> inner) {
  std::vector<SurfacePart> islands;
  if (std::none_of(inner.begin(), inner.end(), [](const InnerSurface& one) {
        return one.cavity;
      })) {
    return islands;
  }
  for (SurfacePart& part : surface_parts(surface)) {
    const Eigen::Vector3d at_m =
        surface.position_m.row(surface.triangle(part.triangle.front(), 0)).transpose();
    if (std::any_of(inner.begin(), inner.end(), [&](const InnerSurface& one) {
          return one.cavity && winding_number(one.surface, at_m) > 0.5;
        })) {
      islands.push_back(std::move(part));
    }
  }
  return islands;
}

Walls make_walls(const SurfaceMesh& surface, std::span<const InnerSurface> inner) {
  const std::vector<SurfacePart> islands = parts_in_cavities(surface, inner);
  Walls walls{.all = surface,
              .inner = {},
              .islands = islands.size(),
              .hollow = std::make_unique<bool[]>(inner.size() + islands.size() + 1),
              .region = {"the body"}};
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const SurfaceMesh& part = inner[i].cut ? SurfaceMesh{} : inner[i].surface;
    const Eigen::Index vertices = walls.all.position_m.rows();
    walls.all.position_m.conservativeResize(vertices + part.position_m.rows(), 3);
    walls.all.position_m.bottomRows(part.position_m.rows()) = part.position_m;
    walls.inner.emplace_back(part.triangle.array() +
                             static_cast<std::int32_t>(vertices));
    const Eigen::Index triangles = walls.all.triangle.rows();
    walls.all.triangle.conservativeResize(triangles + part.triangle.rows(), 3);
    walls.all.triangle.bottomRows(part.triangle.rows()) = walls.inner.back();
    walls.hollow[i + 1] = inner[i].cavity;
    walls.region.push_back(inner_surface_name(inner, i));
  }
  for (const SurfacePart& island : islands) {
    walls.inner.emplace_back(surface.triangle(island.triangle, Eigen::all));
    walls.region.emplace_back("a part in a cavity");
  }
  return walls;
}

void check_vertices(const SurfaceMesh& all, const TetMesh& mesh) {
  const Eigen::Index n = all.position_m.rows();
  if (mesh.position_m.rows() < n || mesh.position_m.topRows(n) != all.position_m) {
    throw NumericalError("tetrahedra: the mesher moved or dropped surface vertices");
  }
}

// Six times the volume under a triangle, seen from the origin.
double under(const Points& position_m, const Triangles& triangle, Eigen::Index t) {
  const Eigen::Vector3d a = position_m.row(triangle(t, 0)).transpose();
  const Eigen::Vector3d b = position_m.row(triangle(t, 1)).transpose();
  const Eigen::Vector3d c = position_m.row(triangle(t, 2)).transpose();
  return a.dot(b.cross(c));
}

// Islands are the body's, once their walls have parted them from the cavities.
void join_islands(const Walls& walls, TetMesh& mesh) {
  const auto first = static_cast<std::int32_t>(walls.inner.size() - walls.islands) + 1;
  std::replace_if(
      mesh.region.begin(), mesh.region.end(),
      [first](std::int32_t region) {
        return region >= first;
      },
      0);
}

// What each region's surface encloses, less what the surfaces in the region do.
std::vector<double> enclosed_m3(const SurfaceMesh& surface, const Walls& walls,
                                const std::vector<std::int32_t>& around) {
  std::vector<double> volume_m3{enclosed_volume_m3(surface)};
  volume_m3.resize(walls.inner.size() + 1, 0.0);
  std::size_t wall = 0;
  for (std::size_t i = 0; i < walls.inner.size(); ++i) {
    for (Eigen::Index t = 0; t < walls.inner[i].rows(); ++t) {
      const double part_m3 = under(walls.all.position_m, walls.inner[i], t) / 6.0;
      volume_m3[i + 1] += part_m3;
      volume_m3[static_cast<std::size_t>(around[wall++])] -= part_m3;
      if (i >= walls.inner.size() - walls.islands) {
        volume_m3[0] -= part_m3;  // it is in the surface, too
      }
    }
  }
  return volume_m3;
}

// Relative: 1e-9 for the body, whose vertices have all come through; 1e-6 for a region,
// a small difference of larger volumes.
void check_volumes(const SurfaceMesh& surface, const Walls& walls,
                   const std::vector<std::int32_t>& around, const TetMesh& mesh) {
  std::vector<double> filled_m3(walls.region.size(), 0.0);
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    const double volume_m3 = tet_volume_m3(mesh, t);
    if (!(volume_m3 > 0.0)) {
      throw NumericalError(fmt::format(
          "tetrahedra: tet {} has a volume of {} m^3: the surface is too flat, or has "
          "vertices too close together, for the mesher",
          t, volume_m3));
    }
    filled_m3[static_cast<std::size_t>(mesh.region[static_cast<std::size_t>(t)])] +=
        volume_m3;
  }
  const std::vector<double> wanted_m3 = enclosed_m3(surface, walls, around);
  const double tolerance = walls.inner.empty() ? 1e-9 : 1e-6;
  for (std::size_t r = 0; r < filled_m3.size(); ++r) {
    if (!(std::abs(filled_m3[r] - wanted_m3[r]) <= tolerance * wanted_m3[r])) {
      throw NumericalError(
          fmt::format("tetrahedra: they fill {} m^3 of {}, its surface encloses {} m^3",
                      filled_m3[r], walls.region[r], wanted_m3[r]));
    }
  }
}

void check_boundary(const SurfaceMesh& surface, const Walls& walls,
                    const TetMesh& mesh) {
  Triangles wanted = surface.triangle;
  for (std::size_t i = 0; i < walls.inner.size(); ++i) {
    if (walls.hollow[i + 1]) {
      const Eigen::Index n = wanted.rows();
      wanted.conservativeResize(n + walls.inner[i].rows(), 3);
      wanted.bottomRows(walls.inner[i].rows()) = walls.inner[i];
    }
  }
  const Triangles found = boundary_faces(mesh.tet);
  if (found.rows() != wanted.rows() || found != sorted_faces(wanted)) {
    throw NumericalError("tetrahedra: their boundary is not the surface's triangles");
  }
}

constexpr std::array<TetTry, 6> kTetTries{{{},
                                           {.improved = false},
                                           {.improved = false, .moved = 1e-9},
                                           {.improved = false, .moved = 1e-7},
                                           {.graded = false},
                                           {.graded = false, .moved = 1e-9}}};

TetMesh try_to_fill(const SurfaceMesh& surface, const Walls& walls,
                    const TetOptions& options, const TetTry& how) {
  const double scale = scale_to_one(surface);
  const ChildResult result = run_in_child(
      tetgen_run, tetgen_input(walls.all, options, scale, how),
      {.time_s = options.time_limit_s, .memory_bytes = options.memory_limit_bytes});
  if (!result.done) {
    const std::string failed =
        fmt::format("tetrahedra: the mesher failed: {}", result.failure);
    if (result.at_limit) {
      throw HopelessTry(failed);
    }
    throw NumericalError(failed);
  }
  // Points that were moved for the mesher go back to where they are.
  TetMesh mesh = tetgen_unpack(result.bytes, options, scale);
  mesh.surface_vertices = surface.position_m.rows();
  if (how.moved > 0.0 && mesh.position_m.rows() >= walls.all.position_m.rows()) {
    mesh.position_m.topRows(walls.all.position_m.rows()) = walls.all.position_m;
  }
  check_vertices(walls.all, mesh);
  // Checks go from what the mesher kept (vertices) to what it filled (volume of
  // regions). The boundary is checked when cavities have been taken out.
  TetRegions regions = tet_regions(mesh.tet, walls.inner);
  mesh.region = std::move(regions.region);
  check_volumes(surface, walls, regions.around, mesh);
  join_islands(walls, mesh);
  const std::span hollow(walls.hollow.get(), walls.region.size());
  if (std::find(hollow.begin(), hollow.end(), true) != hollow.end()) {
    remove_regions(hollow, walls.all.position_m.rows(), mesh);
  }
  check_boundary(surface, walls, mesh);
  return mesh;
}

// What a user can do about a surface that passes our check and does not mesh: where its
// poorest triangle is, and the commands that make a better one.
std::string advice(const SurfaceMesh& surface) {
  double poorest = std::numbers::pi;
  Eigen::Index at = 0;
  for (Eigen::Index t = 0; t < surface.triangle.rows(); ++t) {
    const double angle = smallest_angle_rad(surface, t);
    if (angle < poorest) {
      poorest = angle;
      at = t;
    }
  }
  const Eigen::Vector3d middle = (surface.position_m.row(surface.triangle(at, 0)) +
                                  surface.position_m.row(surface.triangle(at, 1)) +
                                  surface.position_m.row(surface.triangle(at, 2)))
                                     .transpose() /
                                 3.0;
  return fmt::format(
      "the poorest triangle has an angle of {:.2g} deg and lies at ({:.6g}, {:.6g}, "
      "{:.6g}) m: try an even surface, palpate-precompute remesh MESH -o OUT, or "
      "--repair=safe",
      poorest * 180.0 / std::numbers::pi, middle.x(), middle.y(), middle.z());
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

TetMesh tetrahedralise(const SurfaceMesh& surface, const TetOptions& options,
                       std::span<const InnerSurface> inner) {
  check_options(options);
  check_input(surface);
  check_estimate(surface, options);
  const std::vector<InnerSurface> checked = check_inner_surfaces(surface, inner);
  const Walls walls = make_walls(surface, checked);
  std::string first_reason;
  for (const TetTry& how : kTetTries) {
    try {
      return try_to_fill(surface, walls, options, how);
    } catch (const HopelessTry& error) {
      first_reason = first_reason.empty() ? error.what() : first_reason;
      break;
    } catch (const NumericalError& error) {
      first_reason = first_reason.empty() ? error.what() : first_reason;
    }
  }
  throw NumericalError(fmt::format("{}; {}", first_reason, advice(walls.all)));
}

}  // namespace palpate
