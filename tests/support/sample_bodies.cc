#include "tests/support/sample_bodies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpate {
namespace {

constexpr double kGolden = 1.6180339887498949;

SurfaceMesh from_lists(const std::vector<Eigen::Vector3d>& position,
                       const std::vector<Eigen::Vector3i>& triangle) {
  SurfaceMesh mesh;
  mesh.position_m.resize(static_cast<Eigen::Index>(position.size()), 3);
  for (std::size_t i = 0; i < position.size(); ++i) {
    mesh.position_m.row(static_cast<Eigen::Index>(i)) = position[i].transpose();
  }
  mesh.triangle.resize(static_cast<Eigen::Index>(triangle.size()), 3);
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    mesh.triangle.row(static_cast<Eigen::Index>(t)) = triangle[t].transpose();
  }
  return mesh;
}

// The 12 cyclic permutations of (0, +-1, +-golden), and each triple at edge length 2.
SurfaceMesh icosahedron() {
  std::vector<Eigen::Vector3d> position;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-kGolden, kGolden}) {
        Eigen::Vector3d p = Eigen::Vector3d::Zero();
        p[(axis + 1) % 3] = a;
        p[(axis + 2) % 3] = b;
        position.push_back(p);
      }
    }
  }
  std::vector<Eigen::Vector3i> triangle;
  const auto joined = [&](std::size_t i, std::size_t j) {
    return std::abs((position[i] - position[j]).norm() - 2.0) < 1e-9;
  };
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (joined(i, j) && joined(j, k) && joined(k, i)) {
          const bool outward = position[i].dot(position[j].cross(position[k])) > 0.0;
          triangle.emplace_back(i, outward ? j : k, outward ? k : j);
        }
      }
    }
  }
  return from_lists(position, triangle);
}

SurfaceMesh cut_in_four(const SurfaceMesh& mesh) {
  std::vector<Eigen::Vector3d> position;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    position.emplace_back(mesh.position_m.row(v).transpose());
  }
  std::map<std::pair<int, int>, int> middle;
  const auto between = [&](int a, int b) {
    const auto [entry, inserted] =
        middle.try_emplace(std::minmax(a, b), static_cast<int>(position.size()));
    if (inserted) {
      position.emplace_back(0.5 * (position[static_cast<std::size_t>(a)] +
                                   position[static_cast<std::size_t>(b)]));
    }
    return entry->second;
  };
  std::vector<Eigen::Vector3i> triangle;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    const Eigen::Vector3i v = mesh.triangle.row(t).transpose();
    const int a = between(v[0], v[1]);
    const int b = between(v[1], v[2]);
    const int c = between(v[2], v[0]);
    triangle.emplace_back(v[0], a, c);
    triangle.emplace_back(v[1], b, a);
    triangle.emplace_back(v[2], c, b);
    triangle.emplace_back(a, b, c);
  }
  return from_lists(position, triangle);
}

}  // namespace

SurfaceMesh sphere_surface(double radius_m, int refinements) {
  SurfaceMesh mesh = icosahedron();
  for (int i = 0; i < refinements; ++i) {
    mesh = cut_in_four(mesh);
    mesh.position_m.rowwise().normalize();
  }
  mesh.position_m.rowwise().normalize();
  mesh.position_m *= radius_m;
  return mesh;
}

SurfaceMesh stretched(SurfaceMesh mesh, const Eigen::Vector3d& by) {
  mesh.position_m *= by.asDiagonal();
  return mesh;
}

SurfaceMesh organ_like(int refinements) {
  SurfaceMesh mesh = sphere_surface(1.0, refinements);
  for (Eigen::Index i = 0; i < mesh.position_m.rows(); ++i) {
    const Eigen::Vector3d p = mesh.position_m.row(i);
    const double r = 0.06 * (1.0 + 0.25 * p.x() * p.y() + 0.2 * std::cos(3.0 * p.x()));
    mesh.position_m.row(i) = r * Eigen::RowVector3d(1.5 * p.x(), p.y(), 0.6 * p.z());
  }
  return mesh;
}

SurfaceMesh plate(double side_m, int cells) {
  std::vector<Eigen::Vector3d> position;
  std::vector<Eigen::Vector3i> triangle;
  const double step = side_m / cells;
  const int row = cells + 1;
  for (int j = 0; j < row; ++j) {
    for (int i = 0; i < row; ++i) {
      position.emplace_back(step * i - side_m / 2, step * j - side_m / 2, 0.0);
      if (i < cells && j < cells) {
        const int v = j * row + i;
        triangle.emplace_back(v, v + 1, v + row + 1);
        triangle.emplace_back(v, v + row + 1, v + row);
      }
    }
  }
  return from_lists(position, triangle);
}

ToolShape ball(double radius_m, double friction, double presliding_m) {
  return {.name = "ball",
          .radius_m = radius_m,
          .friction = friction,
          .presliding_m = presliding_m};
}

ResponseDatabase sample_database(const SurfaceMesh& mesh, const ToolShape& tool,
                                 const NodeForce& force, double depth_max_m,
                                 int samples) {
  ResponseDatabase database;
  database.body = mesh;
  database.normal = vertex_normals(mesh);
  std::vector<NodeResponse> responses;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    NodeResponse response;
    response.direction = database.normal.row(v).transpose();
    response.origin = ResponseOrigin::kSimulated;
    for (int i = 0; i < samples; ++i) {
      const double d = depth_max_m * i / (samples - 1);
      response.depth_m.push_back(d);
      response.force_n.push_back(i == 0 ? 0.0 : force(v, d));
    }
    responses.push_back(response);
  }
  database.tools.push_back(make_table(tool, responses));
  return database;
}

}  // namespace palpate
